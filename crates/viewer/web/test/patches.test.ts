// Logs that the samples do not have: patches of maps, and topics of another's.

import { create, createFileRegistry, fromBinary, toBinary } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";
import { McapWriter } from "@mcap/core";
import { readFileSync } from "node:fs";

import { expect, test } from "vitest";

import { Container } from "../src/read/container";
import type { Schema } from "../src/read/container";
import { LogReader } from "../src/read/log";
import type { Tell } from "../src/read/protocol";
import { BlobSource } from "../src/read/source";

/** The schema of Grids, as real logs carry it. */
const gridSchema = async (): Promise<Schema> => {
  const sample = readFileSync(new URL("../../../../logs/sample/paper-decisions-5.mcap", import.meta.url));
  const container = new Container(new BlobSource("sample", new Blob([new Uint8Array(sample)])));
  for await (const _ of container.read()) if (container.schemas.size > 0) break;
  const found = [...container.schemas.values()].find(({ name }) => name === "foxglove.Grid");
  if (!found) throw new Error("the sample has maps");
  return found;
};

/** A Grid message: rows from the south, its corner in cells of one metre. */
const grid = (schema: Schema, west: number, south: number, cols: number, values: number[]): Uint8Array => {
  const registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, schema.data));
  const descriptor = registry.getMessage("foxglove.Grid");
  if (!descriptor) throw new Error("the schema describes Grids");
  const message = create(descriptor, {
    pose: { position: { x: west, y: south, z: 0 } },
    columnCount: cols,
    cellSize: { x: 1, y: 1 },
    rowStride: 4 * cols,
    cellStride: 4,
    fields: [{ name: "value", offset: 0, type: 7 }],
    data: new Uint8Array(Float32Array.from(values).buffer),
  } as never);
  return toBinary(descriptor, message);
};

/** A log of 2 rows and 3 columns with these maps, each for a decision. */
const logOf = async (maps: { topic: string; decision: number; data: Uint8Array }[], schema: Schema, timeOf = (place: number): bigint => BigInt(place)): Promise<Uint8Array> => {
  const parts: Uint8Array[] = [];
  let length = 0n;
  const writable = {
    write: async (bytes: Uint8Array) => {
      parts.push(bytes.slice());
      length += BigInt(bytes.byteLength);
    },
    position: () => length,
  };
  const writer = new McapWriter({ writable });
  await writer.start({ library: "test", profile: "wisdom" });
  await writer.addMetadata({ name: "wisdom.run", metadata: new Map(Object.entries({ grid_rows: "2", grid_cols: "3", grid_spacing_m: "1" })) });
  const schemaId = await writer.registerSchema(schema);
  const channels = new Map<string, number>();
  for (const [i, { topic, decision, data }] of maps.entries()) {
    const channelId = channels.get(topic) ?? (await writer.registerChannel({ topic, schemaId, messageEncoding: "protobuf", metadata: new Map() }));
    channels.set(topic, channelId);
    const time = timeOf(i + 1);
    await writer.addMessage({ channelId, sequence: decision, logTime: time, publishTime: time, data });
  }
  await writer.addMetadata({ name: "wisdom.end", metadata: new Map([["status", "waiting"]]) });
  await writer.end();
  return Buffer.concat(parts);
};

test("patches are laid over the last whole map, whichever decision is asked for first", async () => {
  const schema = await gridSchema();
  const bytes = await logOf(
    [
      { topic: "/map/interest", decision: 0, data: grid(schema, 0, 0, 3, [4, 5, 6, 1, 2, 3]) },
      // One cell in the north-east, then two in the south; decision 3 changed nothing.
      { topic: "/map/interest/patch", decision: 1, data: grid(schema, 2, 1, 1, [30]) },
      { topic: "/map/interest/patch", decision: 2, data: grid(schema, 0, 0, 2, [40, 50]) },
      { topic: "/map/interest", decision: 4, data: grid(schema, 0, 0, 3, [0, 0, 0, 0, 0, 0]) },
      { topic: "/somebody/else", decision: 4, data: new Uint8Array([1, 2]) },
    ],
    schema,
  );
  const told: Tell[] = [];
  const reader = new LogReader(new BlobSource("made", new Blob([new Uint8Array(bytes)])), (tell) => told.push(tell));
  await reader.read();
  const values = async (decision: number): Promise<number[]> => [...((await reader.plane("map:interest", decision))?.values ?? [])];
  expect(await values(3)).toEqual([1, 2, 30, 40, 50, 6]);
  expect(await values(0)).toEqual([1, 2, 3, 4, 5, 6]);
  expect(await values(1)).toEqual([1, 2, 30, 4, 5, 6]);
  expect(await values(2)).toEqual([1, 2, 30, 40, 50, 6]);
  expect(await values(9)).toEqual([0, 0, 0, 0, 0, 0]);

  const end = told.find((tell) => tell.kind === "end");
  expect(end?.wholeness).toEqual({ kind: "whole" });
  // What is not known is listed, not hidden.
  expect(end?.topics.filter(({ known }) => !known).map(({ topic, count }) => [topic, count])).toEqual([["/somebody/else", 1]]);
});

test("maps of one time are told apart by their topic", async () => {
  const schema = await gridSchema();
  const bytes = await logOf(
    [
      { topic: "/map/interest", decision: 0, data: grid(schema, 0, 0, 3, [1, 1, 1, 1, 1, 1]) },
      { topic: "/map/ignorance", decision: 0, data: grid(schema, 0, 0, 3, [2, 2, 2, 2, 2, 2]) },
      { topic: "/map/interest/patch", decision: 1, data: grid(schema, 0, 0, 1, [3]) },
    ],
    schema,
    () => 7n,
  );
  const reader = new LogReader(new BlobSource("made", new Blob([new Uint8Array(bytes)])), () => undefined);
  await reader.read();
  const first = async (id: string, decision: number): Promise<number[]> => [...((await reader.plane(id, decision))?.values ?? [])].slice(3);
  expect(await first("map:ignorance", 0)).toEqual([2, 2, 2]);
  expect(await first("map:interest", 0)).toEqual([1, 1, 1]);
  expect(await first("map:interest", 1)).toEqual([3, 1, 1]);
});
