// The sample logs, read as the page reads them; whole, cut anywhere, and damaged.

import { readFileSync } from "node:fs";

import { describe, expect, test } from "vitest";

import { lives } from "../src/model/lives";
import { at } from "../src/model/plane";
import { Run } from "../src/model/run";
import { LogReader } from "../src/read/log";
import type { Tell } from "../src/read/protocol";
import { BlobSource } from "../src/read/source";

const SAMPLES = new URL("../../../../logs/sample/", import.meta.url);
const sample = (name: string): Buffer => readFileSync(new URL(name, SAMPLES));

/** What the page would know of these bytes. */
const read = async (bytes: Uint8Array): Promise<{ run: Run; reader: LogReader }> => {
  const told: Tell[] = [];
  const reader = new LogReader(new BlobSource("test", new Blob([new Uint8Array(bytes)])), (tell) => told.push(tell));
  await reader.read();
  let run: Run | undefined;
  for (const tell of told) {
    if (tell.kind === "facts") run = new Run(tell.facts);
    if (tell.kind === "batch") run?.add(tell.batch);
    if (tell.kind === "end" && run) Object.assign(run, { wholeness: tell.wholeness, end: tell.run, topics: tell.topics, planes: tell.planes });
  }
  if (!run) throw new Error("no facts were told");
  return { run, reader };
};

describe("the sample of today's decisions", () => {
  const whole = read(sample("paper-decisions-5.mcap"));

  test("is whole, with its facts", async () => {
    const { run } = await whole;
    expect(run.wholeness).toEqual({ kind: "whole" });
    expect(run.facts.grid).toEqual({ rows: 101, cols: 101, spacingM: 1, westM: 0, northM: 101 });
    expect(run.facts.run.rule).toBe("dsmc");
    expect(run.facts.experts).toEqual(["dem", "temperature", "texture"]);
    expect(run.end["end.decisions"]).toBe("5");
  });

  test("has its decisions in order, each with a plan that holds its goals", async () => {
    const { run } = await whole;
    expect(run.moments.map(({ number }) => number)).toEqual([0, 1, 2, 3, 4]);
    for (const moment of run.moments) {
      const turns = moment.verdicts.filter(({ turn }) => turn !== undefined);
      expect(moment.legs.map(({ goal }) => goal).sort()).toEqual(turns.map(({ goal }) => goal.id).sort());
      expect(moment.family[moment.chosen]?.order ?? []).toEqual(moment.legs.map(({ goal }) => goal));
      expect(moment.legs.at(-1)?.reliabilitySoFar ?? 1).toBeCloseTo(moment.family[moment.chosen]?.reliability ?? 1, 9);
    }
  });

  test("tells interest on the map as the goals tell it", async () => {
    const { run, reader } = await whole;
    const plane = await reader.plane("map:interest", 0);
    if (!plane) throw new Error("the sample has a map of each decision");
    for (const { goal } of run.moments[0]?.verdicts ?? []) {
      // The map is f32, the goal f64.
      expect(at(plane, goal.target)).toBeCloseTo(goal.interest, 6);
    }
  });

  test("puts readings together", async () => {
    const { run, reader } = await whole;
    expect(run.planes.map(({ id }) => id)).toContain("read:temperature");
    const first = await reader.plane("doubt:temperature", 0);
    const last = await reader.plane("doubt:temperature", 4);
    // Readings are kept where they are surer, so doubt never grows.
    expect(first?.values.every((doubt, i) => (last?.values[i] ?? 1) <= doubt)).toBe(true);
  });

  test("counts every topic", async () => {
    const { run } = await whole;
    expect(run.topics.find(({ topic }) => topic === "/decision")?.count).toBe(5);
    expect(run.topics.every(({ known }) => known)).toBe(true);
  });
});

test.each(["paper-0.1.0.mcap", "paper-decisions-2.mcap", "paper-decisions-3.mcap", "paper-decisions-4.mcap"])("%s can be read", async (name) => {
  const { run } = await read(sample(name));
  expect(run.wholeness.kind).toBe("whole");
  expect(run.moments.length).toBe(Number(run.end["end.decisions"]));
  expect(run.moments[0]?.verdicts.length).toBeGreaterThan(0);
});

test("a file cut anywhere gives its first decisions and says where it ends", async () => {
  const bytes = sample("paper-decisions-5.mcap");
  const whole = await read(bytes);
  let most = 0;
  for (let part = 1; part < 24; part++) {
    const { run } = await read(bytes.subarray(0, Math.floor((bytes.length * part) / 24)));
    expect(run.wholeness.kind).toMatch(/cut|damaged/);
    expect(run.moments).toEqual(whole.run.moments.slice(0, run.moments.length));
    expect(run.moments.length).toBeGreaterThanOrEqual(most);
    most = run.moments.length;
  }
  expect(most).toBe(5);
});

test("a flipped bit in a chunk is told, and what lies before it is shown", async () => {
  const bytes = Buffer.from(sample("paper-decisions-5.mcap"));
  const middle = Math.floor(bytes.length * 0.6);
  bytes[middle] = (bytes[middle] ?? 0) ^ 1;
  const { run } = await read(bytes);
  expect(run.wholeness.kind).toBe("damaged");
  expect(run.moments.length).toBeGreaterThan(0);
  expect(run.moments.length).toBeLessThan(5);
});

test("readings that could not be read once are there when they can be", async () => {
  const bytes = sample("paper-decisions-5.mcap");
  const source = new BlobSource("sample", new Blob([new Uint8Array(bytes)]));
  let broken = false;
  const reader = new LogReader(
    { name: "sample", size: () => source.size(), read: (offset, length) => (broken ? Promise.reject(new Error("the line is down")) : source.read(offset, length)) },
    () => undefined,
  );
  await reader.read();
  const before = await reader.plane("read:temperature", 1);
  broken = true;
  await expect(reader.plane("read:temperature", 4)).rejects.toThrow("the line is down");
  broken = false;
  expect(await reader.plane("read:temperature", 1)).toEqual(before);
  expect((await reader.plane("read:temperature", 4))?.values.some((value, i) => value !== before?.values[i])).toBe(true);
});

test("what is no log is said to be none", async () => {
  const { run } = await read(new TextEncoder().encode("a letter from home"));
  expect(run.wholeness).toMatchObject({ kind: "damaged", at: 0 });
});

test("lives of goals lie within the run, and one that is done ends there", async () => {
  const { run } = await read(sample("paper-decisions-5.mcap"));
  const all = lives(run.moments);
  const known = new Set(run.moments.flatMap(({ verdicts }) => verdicts.map(({ goal }) => goal.id)));
  expect(new Set(all.map(({ goal }) => goal))).toEqual(known);
  for (const life of all) {
    life.stretches.forEach(({ from, to }, i) => {
      expect(from).toBeGreaterThanOrEqual(life.stretches[i - 1]?.to ?? 0);
      expect(to).toBeLessThanOrEqual(run.moments.length);
    });
    if (life.end) expect(life.stretches.at(-1)?.to ?? 0).toBeLessThanOrEqual(life.end.at);
  }
  const achieved = [...run.outcomes.values()].filter(({ result }) => result === "achieved").map(({ goal }) => goal);
  expect(all.filter(({ end }) => end?.state === "done").map(({ goal }) => goal).sort()).toEqual(achieved.sort());
});
