// What a file says of its own soundness, and what is made of it.

import { McapIndexedReader } from "@mcap/core";
import { readFileSync } from "node:fs";
import { crc32 as zlibCrc } from "node:zlib";

import { describe, expect, test } from "vitest";

import { Run } from "../src/model/run";
import { Crc32 } from "../src/read/crc";
import { LogReader } from "../src/read/log";
import { BlobSource } from "../src/read/source";
import { checked } from "../src/ui/runpage";

const SAMPLE = new URL("../../../../logs/sample/paper-decisions-5.mcap", import.meta.url);
const sample = (): Uint8Array => new Uint8Array(readFileSync(SAMPLE));

const read = async (bytes: Uint8Array<ArrayBuffer>): Promise<Run> => {
  let run: Run | undefined;
  const reader = new LogReader(new BlobSource("test", new Blob([bytes])), (tell) => {
    if (tell.kind === "facts") run = new Run(tell.facts);
    if (tell.kind === "batch") run?.add(tell.batch);
    if (tell.kind === "end" && run) Object.assign(run, { wholeness: tell.wholeness, checks: tell.checks, topics: tell.topics, end: tell.run });
  });
  await reader.read();
  if (!run) throw new Error("no facts were told");
  return run;
};

const index = async (bytes: Uint8Array): Promise<McapIndexedReader> =>
  McapIndexedReader.Initialize({
    readable: { size: async () => BigInt(bytes.length), read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)) },
  });

/** A bit turned over at a byte. */
const flipped = (bytes: Uint8Array, at: number): Uint8Array<ArrayBuffer> => {
  const copy = new Uint8Array(bytes);
  copy[at] = (copy[at] ?? 0) ^ 1;
  return copy;
};

describe("the CRC", () => {
  test("of the standard check string is the standard check value", () => {
    const crc = new Crc32();
    crc.add(new TextEncoder().encode("123456789"));
    expect(crc.value).toBe(0xcbf43926);
  });

  test("does not depend on how the bytes come in pieces", () => {
    const bytes = sample().subarray(0, 10_007);
    const [whole, pieces] = [new Crc32(), new Crc32()];
    whole.add(bytes);
    for (let from = 0; from < bytes.length; from += 13) pieces.add(bytes.subarray(from, Math.min(bytes.length, from + 13)));
    expect(pieces.value).toBe(whole.value);
    if (typeof zlibCrc === "function") expect(whole.value).toBe(zlibCrc(bytes));
  });
});

test("of a sound file the data section, the summary, every chunk and every attachment are checked", async () => {
  const { checks, wholeness } = await read(new Uint8Array(sample()));
  const { chunkIndexes, attachmentIndexes } = await index(sample());
  expect(wholeness).toEqual({ kind: "whole" });
  expect(checks).toEqual({ way: "index", chunks: chunkIndexes.length, chunkCrcs: chunkIndexes.length, attachments: attachmentIndexes.length, attachmentsWrong: 0, summary: "right", data: "right" });
  if (checks) expect(checked(checks)).toMatch(/^Read by its index\. CRC of the data section: right; of the summary: right\./);
});

test("a damaged attachment is named by its byte, and all decisions are there all the same", async () => {
  const bytes = sample();
  const one = (await index(bytes)).attachmentIndexes[0];
  if (!one) throw new Error("the sample has attachments");
  const run = await read(flipped(bytes, Number(one.offset + one.length) - 10));
  expect(run.moments).toHaveLength(5);
  expect(run.checks).toMatchObject({ attachmentsWrong: 1, data: "wrong" });
  expect(run.wholeness).toMatchObject({ kind: "damaged" });
  expect("text" in run.wholeness && run.wholeness.text).toMatch(/^Damaged at byte \d+ of \d+: .*CRC.* 5 decisions recovered; the rest was read on\.$/);
});

test("a damaged index is told, and everything is read from the front", async () => {
  const bytes = sample();
  const { footer } = await index(bytes);
  const run = await read(flipped(bytes, Number(footer.summaryStart) + 40));
  expect(run.moments).toHaveLength(5);
  expect(run.checks).toMatchObject({ way: "front", data: "right", summary: "wrong" });
  expect(run.wholeness).toMatchObject({ kind: "damaged", at: Number(footer.summaryStart) });
  expect("text" in run.wholeness && run.wholeness.text).toMatch(/all data are there, but not the index behind them/);
});

test("a bit between the chunks is found by the CRC of the data section alone", async () => {
  const bytes = sample();
  const reader = await index(bytes);
  const chunk = [...reader.chunkIndexes].sort((a, b) => Number(a.chunkStartOffset - b.chunkStartOffset))[0];
  if (!chunk) throw new Error("the sample has chunks");
  // In the message indexes behind the chunk, which the page has no use for.
  const run = await read(flipped(bytes, Number(chunk.chunkStartOffset + chunk.chunkLength) + 30));
  expect(run.moments).toHaveLength(5);
  expect(run.checks).toMatchObject({ data: "wrong", summary: "right", chunkCrcs: 5 });
  expect(run.wholeness).toMatchObject({ kind: "damaged", at: Number(reader.dataEndOffset) });
});
