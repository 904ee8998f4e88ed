// Two runs term by term; lives that grow; addresses; tables.

import { readFileSync } from "node:fs";

import { describe, expect, test } from "vitest";

import { divergence } from "../src/model/divergence";
import type { Section, Words } from "../src/model/divergence";
import { Lives, lives } from "../src/model/lives";
import { paired } from "../src/model/pairs";
import { Run } from "../src/model/run";
import { asked, written } from "../src/page/address";
import type { Held } from "../src/page/address";
import { LogReader } from "../src/read/log";
import { BlobSource } from "../src/read/source";
import { csv, fileName } from "../src/ui/export";
import { legible } from "../src/ui/dom";
import { goalName, reason, trigger } from "../src/ui/format";
import { sectionsOf } from "../src/ui/terms";
import { decisionsTable, plansTable } from "../src/ui/tables";
import { TimeScale } from "../src/view/timescale";

const read = async (name: string): Promise<Run> => {
  const bytes = readFileSync(new URL(`../../../../logs/sample/${name}`, import.meta.url));
  let run: Run | undefined;
  const reader = new LogReader(new BlobSource(name, new Blob([new Uint8Array(bytes)])), (tell) => {
    if (tell.kind === "facts") run = new Run(tell.facts);
    if (tell.kind === "batch") run?.add(tell.batch);
  });
  await reader.read();
  if (!run) throw new Error("no facts were told");
  return run;
};
const sample = read("paper-decisions-5.mcap");

const GRID = { rows: 100, cols: 100, spacingM: 1, westM: 0, northM: 0 };
const words: Words = { trigger, reason, goal: goalName };
const differing = (sections: Section[]): string[] => sections.flatMap(({ rows }) => rows.filter(({ same }) => !same).map(({ label }) => label));

describe("goals of two runs", () => {
  const at = (id: number, col: number, directive = "image"): { id: number; directive: string; target: { row: number; col: number } } => ({ id, directive, target: { row: 0, col } });

  test("are paired with the nearest of their place, one with one", () => {
    const pairs = paired([at(1, 10), at(2, 14)], [at(7, 13), at(8, 30)], GRID, 5);
    expect(pairs.map(({ a, b }) => [a?.id, b?.id])).toEqual([[1, undefined], [2, 7], [undefined, 8]]);
  });

  test("are not paired across directives, nor beyond the radius", () => {
    expect(paired([at(1, 10)], [at(7, 10, "drill"), at(8, 16)], GRID, 5)).toHaveLength(3);
    expect(paired([at(1, 10)], [at(8, 15)], GRID, 5)).toHaveLength(1);
  });
});

describe("term by term", () => {
  test("a decision does not differ from itself", async () => {
    const run = await sample;
    const moment = run.moments[1];
    if (!moment) throw new Error("the sample has five decisions");
    expect(differing(sectionsOf({ run, index: 1, moment }, { run, index: 1, moment }))).toEqual([]);
  });

  test("goals are the same under other names, and one changed number is the one that differs", async () => {
    const run = await sample;
    const moment = run.moments[1];
    if (!moment) throw new Error("the sample has five decisions");
    // The second run calls every goal by another number, and believes one a little more.
    const renamed = (id: number | undefined): number | undefined => (id === undefined ? undefined : id + 500);
    const changed = moment.verdicts[0]?.goal.id;
    const other = {
      ...moment,
      underway: renamed(moment.underway),
      act: { ...moment.act, goal: renamed(moment.act.goal) },
      triggers: moment.triggers.map((one) => ({ ...one, goal: renamed(one.goal) })),
      legs: moment.legs.map((leg) => ({ ...leg, goal: leg.goal + 500 })),
      verdicts: moment.verdicts.map((verdict) => ({
        ...verdict,
        other: renamed(verdict.other),
        goal: { ...verdict.goal, id: verdict.goal.id + 500, interest: verdict.goal.interest + (verdict.goal.id === changed ? 1e-9 : 0) },
      })),
    };
    const second = new Run(run.facts);
    second.add({ moments: [other], outcomes: [], looks: [], happenings: [], lines: [] });
    const first = new Run(run.facts);
    first.add({ moments: [moment], outcomes: [], looks: [], happenings: [], lines: [] });
    const sections = divergence({ run: first, index: 0, moment }, { run: second, index: 0, moment: other }, run.facts.grid, run.facts.identityRadiusM, words);
    expect(differing(sections)).toEqual(["interest"]);
  });

  test("every goal of either side has its terms", async () => {
    const [a, b] = [await sample, await read("paper-decisions-4.mcap")];
    const [one, other] = [a.moments[1], b.moments[1]];
    if (!one || !other) throw new Error("both have five decisions");
    const sections = sectionsOf({ run: a, index: 1, moment: one }, { run: b, index: 1, moment: other });
    const named = (side: "a" | "b"): number[] => sections.flatMap(({ goal }) => goal?.[side]?.id ?? []).sort((x, y) => x - y);
    expect(named("a")).toEqual(one.verdicts.map(({ goal }) => goal.id).sort((x, y) => x - y));
    expect(named("b")).toEqual(other.verdicts.map(({ goal }) => goal.id).sort((x, y) => x - y));
  });
});

test("lives taken in as decisions come are those of the whole run", async () => {
  const { moments } = await sample;
  const growing = new Lives();
  for (let upTo = 0; upTo <= moments.length; upTo++) growing.take(moments.slice(0, upTo));
  expect(growing.lanes).toEqual(lives(moments));
});

test("what was said last of a goal is found from any decision, ended goals included", async () => {
  const run = await sample;
  for (let index = 0; index < run.moments.length; index++) {
    const expected = new Map<number, number>();
    for (let i = 0; i <= index; i++) for (const { goal } of run.moments[i]?.verdicts ?? []) expected.set(goal.id, i);
    const found = run.verdictsUpTo(index);
    expect(new Map([...found].map(([goal, { index: said }]) => [goal, said]))).toEqual(expected);
  }
});

describe("the address", () => {
  const plain: Held = { layer: "map:interest", goal: undefined, tab: "goals", axis: "time", aspect: "value", split: "wipe", solid: false, probe: undefined, probed: "a", subject: "a" };

  test("of an ordinary moment is its decision alone", () => {
    expect(written(7, plain)).toBe("#d=7");
  });

  test("holds all that is looked at, and gives it back", () => {
    const all: Held = { layer: "read:a b&c=d", goal: 6, tab: "plans", axis: "decision", aspect: "between", split: "halves", solid: true, probe: { row: 34, col: 57 }, probed: "b", subject: "a" };
    expect(asked(written(12, all))).toEqual({ decision: 12, view: all });
  });

  test("with nonsense in it is read as if that were not there", () => {
    expect(asked("#d=x&tab=<b>&cell=1,&goal=-3&axis=up")).toEqual({ decision: undefined, view: plain });
  });
});

describe("tables", () => {
  test("quote what must be quoted and end lines as RFC 4180 has it", () => {
    expect(csv([["a", 1, undefined], ['say "no", twice', "two\r\nlines", "=1+1"]])).toBe('a,1,\r\n"say ""no"", twice","two\r\nlines",=1+1\r\n');
  });

  test("have the log's own numbers, and as many fields in every row", async () => {
    const run = await sample;
    const moment = run.moments[0];
    if (!moment) throw new Error("the sample has five decisions");
    for (const table of [plansTable(moment), decisionsTable(run)]) expect(new Set(table.map((row) => row.length)).size).toBe(1);
    expect(plansTable(moment)[1]).toContain(moment.family[0]?.energyJ);
    expect(decisionsTable(run)).toHaveLength(6);
  });

  test("are saved under names that say mission, decision and what", async () => {
    const run = await sample;
    expect(fileName(run, run.moments[3], "goals", "csv")).toBe("paper-d3-goals.csv");
    const hostile = new Run({ ...run.facts, run: { mission: "../../etc/<passwd>\u0000" } });
    expect(fileName(hostile, undefined, "run", "csv")).toMatch(/^[A-Za-z0-9._-]+-run\.csv$/);
    expect(fileName(hostile, undefined, "run", "csv")).not.toMatch(/^\./);
  });
});

test("text that hides or runs backwards is shown by its code, and a long one by its beginning", () => {
  expect(legible("a\u0000b\u202Ec\u200Fd\te\nf")).toBe("a⟨U+0000⟩b⟨U+202E⟩c⟨U+200F⟩d\te\nf");
  const long = legible("W".repeat(100_000));
  expect(long.length).toBeLessThan(1100);
  expect(long).toMatch(/… \(99000 characters more\)$/);
});

test("under one scale a pixel leads back to the decision that lies there, by either axis", async () => {
  const [a, b] = [await sample, await read("paper-decisions-4.mcap")];
  for (const axis of ["time", "decision"] as const) {
    const scale = new TimeScale([a, b], axis, 80, 1000);
    for (const run of [a, b]) run.moments.forEach((_, index) => expect(scale.indexAt(run, scale.x(run, index))).toBe(index));
    expect(scale.indexAt(a, -500)).toBe(0);
    expect(scale.indexAt(a, 9000)).toBe(a.moments.length - 1);
  }
});
