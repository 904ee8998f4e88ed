// The container: an MCAP file read piece by piece, whole or not.
//
// A whole file is read by its index, chunk after chunk. One without a readable end is walked from the front,
// record by record, up to the first byte that cannot be read. Chunk CRCs are checked in both cases.

import { McapIndexedReader, McapRecordBuilder, McapStreamReader } from "@mcap/core";
import type { McapTypes } from "@mcap/core";
import { decompress } from "fzstd";

import type { Source } from "./source";

type Record_ = McapTypes.TypedMcapRecord;
export type Schema = McapTypes.TypedMcapRecords["Schema"];
export type Channel = McapTypes.TypedMcapRecords["Channel"];
export type Message = McapTypes.TypedMcapRecords["Message"];

/** Where a chunk lies in the file: enough to read its messages again. */
export interface Piece {
  offset: bigint;
  length: bigint;
}

export type Found =
  | { kind: "metadata"; name: string; entries: Map<string, string> }
  | { kind: "attachment"; name: string; bytes: number; data?: Uint8Array }
  | { kind: "chunk"; piece: Piece; messages: Message[] };

/** How reading ended. */
export type End = { kind: "whole" } | { kind: "cut" | "damaged"; at: number; why: string };

const MAGIC_BYTES = 8n;
/** Opcode and length. */
const HEAD_BYTES = 9n;
const FOOTER = 0x02;
const DATA_END = 0x0f;
/** A record longer than this in a file without an index is taken for damage, not for a record. */
const LONGEST_RECORD = 1n << 31n;

const zstd = (packed: Uint8Array, size: bigint): Uint8Array => decompress(packed, new Uint8Array(Number(size)));

export class Container {
  readonly schemas = new Map<number, Schema>();
  readonly channels = new Map<number, Channel>();

  private preludeBytes = new Uint8Array();
  private preludeChannels = 0;

  constructor(readonly source: Source) {}

  /** Everything in the file, front to back. Returns how it ended. */
  async *read(): AsyncGenerator<Found, End, void> {
    const index = await this.index();
    return yield* index ? this.byIndex(index) : this.fromTheFront();
  }

  /** The messages of a chunk that was read before. */
  async messages(piece: Piece): Promise<Message[]> {
    const bytes = await this.source.read(piece.offset, piece.length);
    return this.parse(bytes).filter((record): record is Message => record.type === "Message");
  }

  private async index(): Promise<McapIndexedReader | undefined> {
    try {
      return await McapIndexedReader.Initialize({ readable: this.source, decompressHandlers: { zstd } });
    } catch {
      // No footer, or a damaged one: what is there is found by walking.
      return undefined;
    }
  }

  private async *byIndex(index: McapIndexedReader): AsyncGenerator<Found, End, void> {
    for (const [id, schema] of index.schemasById) this.schemas.set(id, schema);
    for (const [id, channel] of index.channelsById) this.channels.set(id, channel);
    try {
      for await (const record of index.readMetadata()) yield metadata(record);
      for await (const record of index.readAttachments()) {
        yield { kind: "attachment", name: record.name, bytes: record.data.byteLength, data: record.data };
      }
    } catch (error) {
      const first = index.metadataIndexes[0]?.offset ?? MAGIC_BYTES;
      return { kind: "damaged", at: Number(first), why: said(error) };
    }
    const chunks = [...index.chunkIndexes].sort((a, b) => (a.chunkStartOffset < b.chunkStartOffset ? -1 : 1));
    for (const { chunkStartOffset: offset, chunkLength: length } of chunks) {
      try {
        const piece = { offset, length };
        const messages = await this.messages(piece);
        yield { kind: "chunk", piece, messages };
      } catch (error) {
        return { kind: "damaged", at: Number(offset), why: said(error) };
      }
    }
    return { kind: "whole" };
  }

  private async *fromTheFront(): AsyncGenerator<Found, End, void> {
    const size = await this.source.size();
    let offset = 0n;
    try {
      const magic = await this.source.read(0n, size < MAGIC_BYTES ? size : MAGIC_BYTES);
      // "MCAP" between two bytes that text never has.
      if (size < MAGIC_BYTES || String.fromCharCode(...magic.subarray(1, 5)) !== "MCAP") {
        return { kind: "damaged", at: 0, why: "this is not an MCAP file" };
      }
      offset = MAGIC_BYTES;
      while (offset + HEAD_BYTES <= size) {
        const head = await this.source.read(offset, HEAD_BYTES);
        const opcode = head[0];
        const content = new DataView(head.buffer, head.byteOffset).getBigUint64(1, true);
        const length = HEAD_BYTES + content;
        if (opcode === FOOTER) break;
        if (opcode === undefined || opcode === 0 || length > LONGEST_RECORD) {
          return { kind: "damaged", at: Number(offset), why: `opcode ${opcode} and length ${content} make no record` };
        }
        if (offset + length > size) {
          return { kind: "cut", at: Number(offset), why: `the record here goes on to byte ${offset + length}` };
        }
        // What follows are indexes of what was just read.
        if (opcode === DATA_END) break;
        const piece = { offset, length };
        yield* this.found(piece, this.parse(await this.source.read(offset, length)));
        offset += length;
      }
    } catch (error) {
      return { kind: "damaged", at: Number(offset), why: said(error) };
    }
    return { kind: "cut", at: Number(offset), why: "there is no index and no end" };
  }

  private *found(piece: Piece, records: Record_[]): Generator<Found, void, void> {
    const messages: Message[] = [];
    for (const record of records) {
      if (record.type === "Message") messages.push(record);
      if (record.type === "Metadata") yield metadata(record);
      if (record.type === "Attachment") {
        yield { kind: "attachment", name: record.name, bytes: record.data.byteLength, data: record.data };
      }
    }
    if (messages.length > 0) yield { kind: "chunk", piece, messages };
  }

  /** The records in the bytes of one record; many if it is a chunk. */
  private parse(bytes: Uint8Array): Record_[] {
    const reader = new McapStreamReader({ decompressHandlers: { zstd }, validateCrcs: true, noMagicPrefix: true });
    // A chunk may rely on channels that an earlier one declared, and the reader wants them first.
    reader.append(this.prelude());
    let known = this.preludeChannels;
    reader.append(bytes);
    const records: Record_[] = [];
    for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
      if (record.type === "Channel" && known-- > 0) continue;
      if (record.type === "Schema") this.schemas.set(record.id, record);
      if (record.type === "Channel") this.channels.set(record.id, record);
      records.push(record);
    }
    if (reader.bytesRemaining() > 0) throw new Error(`${reader.bytesRemaining()} bytes left over`);
    return records;
  }

  /** All channels known so far, as records. */
  private prelude(): Uint8Array {
    if (this.preludeChannels !== this.channels.size) {
      const builder = new McapRecordBuilder();
      for (const channel of this.channels.values()) builder.writeChannel(channel);
      this.preludeBytes = builder.buffer.slice();
      this.preludeChannels = this.channels.size;
    }
    return this.preludeBytes;
  }
}

const metadata = (record: McapTypes.TypedMcapRecords["Metadata"]): Found => ({
  kind: "metadata",
  name: record.name,
  entries: record.metadata,
});

const said = (error: unknown): string => (error instanceof Error ? error.message.replace(/ \[.*\]$/, "") : String(error));
