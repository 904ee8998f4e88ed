import { readFileSync } from "node:fs";

import { beforeAll, describe, expect, test } from "vitest";

import { Run } from "../src/model/run";
import { LogReader } from "../src/read/log";
import type { Tell } from "../src/read/protocol";
import { BlobSource } from "../src/read/source";
import { shapes } from "../src/view/shapes";
import type { Marked, Way } from "../src/view/shapes";

/** The sample's run, as the page has it. */
const sample = async (): Promise<Run> => {
  const bytes = readFileSync(new URL("../../../../logs/sample/paper-decisions-5.mcap", import.meta.url));
  let run: Run | undefined;
  const hear = (tell: Tell): void => {
    if (tell.kind === "facts") run = new Run(tell.facts);
    if (tell.kind === "batch") run?.add(tell.batch);
  };
  await new LogReader(new BlobSource("sample", new Blob([new Uint8Array(bytes)])), hear).read();
  if (!run) throw new Error("the sample has facts");
  return run;
};

describe("what is drawn over the ground", () => {
  let run: Run;
  beforeAll(async () => {
    run = await sample();
  });
  const marked = (more: Partial<Marked> = {}): Marked => ({ run, index: 0, goal: undefined, option: undefined, alternatives: false, family: undefined, ...more });
  const ways = (of: Marked, what: Way["what"]): Way[] => shapes(of).flatMap((shape) => (shape.kind === "way" && shape.what === what ? [shape] : []));
  const others = (): number => (run.moment(0)?.family.length ?? 0) - 1;

  test("is made once, and anew when what is looked at changes", () => {
    expect(shapes(marked())).toBe(shapes(marked()));
    expect(shapes(marked({ goal: 6 }))).not.toBe(shapes(marked()));
  });

  test("has the next leg over the plan, goals over ways, and the rover on top", () => {
    const kinds = shapes(marked()).map((shape) => (shape.kind === "way" ? shape.what : shape.kind));
    expect(kinds.slice(0, 4)).toEqual(["driven", "pose to goal", "plan", "next leg"]);
    expect(kinds.at(-1)).toBe("rover");
    expect(kinds.indexOf("mark")).toBeGreaterThan(kinds.indexOf("next leg"));
  });

  test("joins each leg's end to the goal that it is for, where they are not one cell", () => {
    const moment = run.moment(0);
    const target = (goal: number): unknown => moment?.verdicts.find((verdict) => verdict.goal.id === goal)?.goal.target;
    const apart = moment?.legs.filter(({ goal, pose }) => JSON.stringify(target(goal)) !== JSON.stringify(pose)) ?? [];
    expect(apart.length).toBeGreaterThan(0);
    expect(ways(marked(), "pose to goal").flatMap(({ lines }) => lines)).toEqual(apart.map(({ goal, pose }) => [pose, target(goal)]));
  });

  test("has the members of the family as broken straight lines where their ways are not known", () => {
    const found = ways(marked({ alternatives: true }), "alternative");
    expect(found).toHaveLength(others());
    const other = run.moment(0)?.family.findIndex((_, option) => option !== run.moment(0)?.chosen) ?? 0;
    const poses = run.moment(0)?.family[other]?.poses ?? [];
    expect(found[0]?.lines).toEqual([[run.moment(0)?.pose, ...poses]]);
    expect(found.every(({ dash }) => dash.length > 0)).toBe(true);
  });

  test("has them whole and unbroken where they are known, the picked one stronger", () => {
    const family = (run.moment(0)?.family ?? []).map((_, option) => [{ row: 0, col: 0 }, { row: option, col: 1 }, { row: option, col: 2 }]);
    const found = ways(marked({ alternatives: true, family }), "alternative");
    expect(found.every(({ dash, lines }) => dash.length === 0 && lines[0]?.length === 3)).toBe(true);
    const option = run.moment(0)?.chosen === 0 ? 1 : 0;
    const [picked] = ways(marked({ option, family }), "picked alternative");
    expect(picked?.lines).toEqual([family[option]]);
    expect(picked?.width).toBeGreaterThan(found[0]?.width ?? 0);
    expect(ways(marked({ option: run.moment(0)?.chosen, family }), "picked alternative")).toEqual([]);
  });

  test("has each goal once, the picked one on top of all", () => {
    const goals = shapes(marked({ goal: 0 })).flatMap((shape) => (shape.kind === "mark" ? [shape] : []));
    expect(new Set(goals.map(({ goal }) => goal)).size).toBe(goals.length);
    expect(goals.at(-1)).toMatchObject({ goal: 0, picked: true });
    expect(goals.find(({ state }) => state === "next")?.turn).toBe(0);
  });
});
