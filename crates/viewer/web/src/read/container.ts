// The container: an MCAP file read piece by piece, whole or not.
//
// A whole file is read by its index, chunk after chunk. One without a readable end is walked from the front,
// record by record, up to the first byte that cannot be read. Every CRC that the file has is checked in both cases.

import { McapIndexedReader, McapRecordBuilder, McapStreamReader } from "@mcap/core";
import type { McapTypes } from "@mcap/core";
import { decompress } from "fzstd";

import type { Checks } from "../model/types";
import type { Source } from "./source";
import { DataSum } from "./sum";

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
  | { kind: "attachment"; name: string; data: Uint8Array }
  | { kind: "chunk"; piece: Piece; messages: Message[] };

/** How reading ended; `stopped` if nothing behind that byte was read. */
export type End = { kind: "whole" } | Fault_;
interface Fault_ {
  kind: "cut" | "damaged" | "foreign";
  at: number;
  why: string;
  stopped: boolean;
}

const MAGIC_BYTES = 8n;
/** Opcode and length. */
const HEAD_BYTES = 9n;
const FOOTER = 0x02;
const CHUNK = 0x06;
const ATTACHMENT = 0x09;
const DATA_END = 0x0f;
/** Opcode, length, two times and the size come before it. */
const CHUNK_CRC_AT = 33;
/** A record longer than this in a file without an index is taken for damage, not for a record. */
const LONGEST_RECORD = 1n << 31n;
/** A chunk's message indexes are read along with it, if they are no longer than this. */
const LONGEST_GAP = 1n << 20n;

const zstd = (packed: Uint8Array, size: bigint): Uint8Array => decompress(packed, new Uint8Array(Number(size)));

const damaged = (at: bigint, error: unknown, stopped: boolean): Fault_ => ({ kind: "damaged", at: Number(at), why: said(error), stopped });

export class Container {
  readonly schemas = new Map<number, Schema>();
  readonly channels = new Map<number, Channel>();
  /** What was held against its CRC so far. */
  readonly checks: Checks = { way: "index", chunks: 0, chunkCrcs: 0, attachments: 0, attachmentsWrong: 0, summary: "unread", data: "unread" };

  private preludeBytes = new Uint8Array();
  private preludeChannels = 0;
  private noIndex = "";

  constructor(readonly source: Source) {}

  /** Everything in the file, front to back. Returns how it ended. */
  async *read(): AsyncGenerator<Found, End, void> {
    const index = await this.index();
    return yield* index ? this.byIndex(index) : this.fromTheFront();
  }

  /** The messages of a chunk that was read before. */
  async messages(piece: Piece): Promise<Message[]> {
    return this.messagesIn(await this.source.read(piece.offset, piece.length));
  }

  private messagesIn(bytes: Uint8Array): Message[] {
    return this.parse(bytes).filter((record): record is Message => record.type === "Message");
  }

  private async index(): Promise<McapIndexedReader | undefined> {
    try {
      return await McapIndexedReader.Initialize({ readable: this.source, decompressHandlers: { zstd } });
    } catch (error) {
      // No footer, or a damaged one: what is there is found by walking.
      this.noIndex = said(error);
      this.checks.way = "front";
      if (/summary crc/i.test(this.noIndex)) this.checks.summary = "wrong";
      return undefined;
    }
  }

  private async *byIndex(index: McapIndexedReader): AsyncGenerator<Found, End, void> {
    const { checks } = this;
    for (const [id, schema] of index.schemasById) this.schemas.set(id, schema);
    for (const [id, channel] of index.channelsById) this.channels.set(id, channel);
    // The index was not taken without it.
    checks.summary = index.footer.summaryCrc === 0 ? "absent" : "right";
    let worst: Fault_ | undefined;
    for (const { offset, length } of [...index.metadataIndexes, ...index.attachmentIndexes]) {
      try {
        yield* this.found({ offset, length }, await this.source.read(offset, length));
      } catch (error) {
        // Decisions do not hang on it: they are in the chunks.
        worst ??= damaged(offset, error, false);
      }
    }
    const sum = new DataSum(this.source);
    const chunks = [...index.chunkIndexes].sort((a, b) => (a.chunkStartOffset < b.chunkStartOffset ? -1 : 1));
    for (const [i, { chunkStartOffset: offset, chunkLength: length }] of chunks.entries()) {
      try {
        const gap = (chunks[i + 1]?.chunkStartOffset ?? index.dataEndOffset) - offset - length;
        const bytes = await this.source.read(offset, gap > 0n && gap <= LONGEST_GAP ? length + gap : length);
        await sum.take(offset, bytes);
        const own = bytes.subarray(0, Number(length));
        this.countChunk(own);
        yield { kind: "chunk", piece: { offset, length }, messages: this.messagesIn(own) };
      } catch (error) {
        return damaged(offset, error, true);
      }
    }
    worst = (await this.dataSection(sum, index.dataEndOffset, index.dataSectionCrc ?? 0)) ?? worst;
    return worst ?? { kind: "whole" };
  }

  /** Holds the sum against what the file says of it, if it says so. */
  private async dataSection(sum: DataSum, end: bigint, expected: number): Promise<Fault_ | undefined> {
    if (expected === 0) {
      this.checks.data = "absent";
      return undefined;
    }
    const found = await sum.value(end);
    this.checks.data = found === expected ? "right" : "wrong";
    return found === expected ? undefined : damaged(end, `the CRC of all bytes before it is ${hex(found)}, the file says ${hex(expected)}`, false);
  }

  private async *fromTheFront(): AsyncGenerator<Found, End, void> {
    const size = await this.source.size();
    const sum = new DataSum(this.source);
    let offset = 0n;
    try {
      const magic = await this.source.read(0n, size < MAGIC_BYTES ? size : MAGIC_BYTES);
      // "MCAP" between two bytes that text never has.
      if (size < MAGIC_BYTES || String.fromCharCode(...magic.subarray(1, 5)) !== "MCAP") {
        return { kind: "foreign", at: 0, why: "it does not begin as one", stopped: true };
      }
      await sum.take(0n, magic);
      offset = MAGIC_BYTES;
      while (offset + HEAD_BYTES <= size) {
        const head = await this.source.read(offset, HEAD_BYTES);
        const opcode = head[0];
        const content = new DataView(head.buffer, head.byteOffset).getBigUint64(1, true);
        const length = HEAD_BYTES + content;
        if (opcode === FOOTER) break;
        if (opcode === undefined || opcode === 0 || length > LONGEST_RECORD) {
          return damaged(offset, `opcode ${opcode} and length ${content} make no record`, true);
        }
        if (offset + length > size) {
          return { kind: "cut", at: Number(offset), why: `the record here goes on to byte ${offset + length}`, stopped: true };
        }
        const bytes = await this.source.read(offset, length);
        if (opcode === DATA_END) return await this.behindTheData(sum, offset, bytes);
        await sum.take(offset, bytes);
        yield* this.found({ offset, length }, bytes);
        offset += length;
      }
    } catch (error) {
      return damaged(offset, error, true);
    }
    return { kind: "cut", at: Number(offset), why: "there is no index and no end", stopped: true };
  }

  /** What follows the data are indexes of what was just read; only why there was no use for them is told. */
  private async behindTheData(sum: DataSum, offset: bigint, bytes: Uint8Array): Promise<End> {
    const expected = bytes.length >= 13 ? new DataView(bytes.buffer, bytes.byteOffset).getUint32(9, true) : 0;
    const wrong = await this.dataSection(sum, offset, expected);
    if (wrong) return wrong;
    if (!/not indexed/.test(this.noIndex)) return damaged(offset + BigInt(bytes.length), `all data are there, but not the index behind them (${this.noIndex})`, false);
    this.checks.summary = "absent";
    return { kind: "whole" };
  }

  private *found(piece: Piece, bytes: Uint8Array): Generator<Found, void, void> {
    if (bytes[0] === CHUNK) this.countChunk(bytes);
    const messages: Message[] = [];
    let records: Record_[];
    try {
      records = this.parse(bytes);
    } catch (error) {
      if (bytes[0] === ATTACHMENT) this.checks.attachmentsWrong += 1;
      throw error;
    }
    for (const record of records) {
      if (record.type === "Message") messages.push(record);
      if (record.type === "Metadata") yield { kind: "metadata", name: record.name, entries: record.metadata };
      if (record.type === "Attachment") {
        this.checks.attachments += 1;
        yield { kind: "attachment", name: record.name, data: record.data };
      }
    }
    if (messages.length > 0) yield { kind: "chunk", piece, messages };
  }

  private countChunk(bytes: Uint8Array): void {
    this.checks.chunks += 1;
    const crc = bytes.length >= CHUNK_CRC_AT + 4 ? new DataView(bytes.buffer, bytes.byteOffset).getUint32(CHUNK_CRC_AT, true) : 0;
    if (crc !== 0) this.checks.chunkCrcs += 1;
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

const hex = (crc: number): string => crc.toString(16).padStart(8, "0");

const said = (error: unknown): string => (error instanceof Error ? error.message.replace(/ \[.*\]$/, "") : String(error));
