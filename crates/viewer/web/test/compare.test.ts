import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { aligned, factPairs, firstDivergence } from "../src/model/compare";
import { Run } from "../src/model/run";
import type { Moment } from "../src/model/types";
import { LogReader } from "../src/read/log";
import { BlobSource } from "../src/read/source";

const GRID = { rows: 100, cols: 100, spacingM: 1, westM: 0, northM: 0 };

/** A decision whose sequence is goals at these columns. */
const chose = (...cols: number[]): Moment =>
  ({
    act: { name: "pursue" },
    verdicts: cols.map((col, turn) => ({ turn, goal: { id: 10 * turn + col, directive: "image", target: { row: 0, col }, prize: 1 } })),
  }) as unknown as Moment;

const columns = (pairs: ReturnType<typeof aligned>): string[] => pairs.map(({ a, b }) => `${a?.target.col ?? "-"}/${b?.target.col ?? "-"}`);

test("sequences are aligned by place, whatever the goals are called", () => {
  expect(columns(aligned(chose(0, 20, 40), chose(1, 41), GRID, 5))).toEqual(["0/1", "20/-", "40/41"]);
  expect(columns(aligned(chose(), chose(7), GRID, 5))).toEqual(["-/7"]);
  expect(columns(aligned(chose(0, 20), chose(20, 0), GRID, 5))).toHaveLength(3);
});

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

test("a run does not part from itself, and runs of other lengths part at the latest where one ends", async () => {
  const [a, b] = [await read("paper-decisions-5.mcap"), await read("paper-0.1.0.mcap")];
  expect(firstDivergence(a, a)).toBeUndefined();
  expect(firstDivergence(a, b)).toBeLessThanOrEqual(b.moments.length);
});

test("what a file does not tell is another thing than what it says is empty", async () => {
  const [old, now] = [await read("paper-0.1.0.mcap"), await read("paper-decisions-5.mcap")];
  const pairs = factPairs(old, now);
  const untold = pairs.filter(({ a, b }) => a === undefined && b !== undefined).map(({ key }) => key);
  expect(untold).toEqual(Object.keys(now.facts.run).filter((key) => !(key in old.facts.run)));
  expect(untold.length).toBeGreaterThan(0);
});
