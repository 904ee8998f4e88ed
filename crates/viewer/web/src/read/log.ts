// A log being read: what was found, told in batches.

import { experts, hysteresis, identityRadiusM, weights } from "../model/mission";
import type { Plane } from "../model/plane";
import type { GridSpec, TopicCount, Wholeness } from "../model/types";
import type { Relief } from "../view/relief";
import { Container } from "./container";
import type { Channel, End, Message, Piece } from "./container";
import { Decoder, fault, look, message, moment, num, outcome, str } from "./decode";
import type { Fields } from "./decode";
import { Layers } from "./layers";
import type { Batch, Tell } from "./protocol";
import type { Source } from "./source";

/** Topics that this page reads; `/map/*` besides. Others are counted and listed. */
const KNOWN = new Set(["/in/observation", "/in/outcome", "/in/message", "/truth/fault", "/decision", "/log"]);
/** Said by other topics too: drawn from the decisions themselves. */
const REDUNDANT = new Set(["/scene", "/rover/pose", "/tf", "/terrain/interest"]);
/** Readings of layers are wanted by few, and are most of the bytes: a look is decoded without them at first. */
const READINGS = ["LayerWindow.values", "LayerWindow.uncertainty"];
/** A grid with longer sides is taken for nonsense. */
const LONGEST_SIDE = 1 << 16;

const emptyBatch = (): Batch => ({ moments: [], outcomes: [], looks: [], happenings: [], lines: [] });

const seconds = (ns: bigint): number => Number(ns / 1000n) / 1e6;

export class LogReader {
  private readonly container: Container;
  private readonly decoders = new Map<string, Decoder>();
  private readonly attachments = new Map<string, Uint8Array>();
  private readonly counts = new Map<string, TopicCount>();
  private readonly layers: Layers;
  private readonly run: Record<string, string> = {};
  private decisions = 0;
  private ended = false;
  private told = false;

  constructor(
    private readonly source: Source,
    private readonly tell: (tell: Tell) => void,
  ) {
    this.container = new Container(source);
    this.layers = new Layers(this.container, (channel) => this.decoder(channel));
  }

  /** Reads the file from front to back. */
  async read(): Promise<void> {
    const bytes = Number(await this.source.size());
    const found = this.container.read();
    let step = await found.next();
    for (; !step.done; step = await found.next()) {
      const it = step.value;
      if (it.kind === "metadata") {
        this.metadata(it.name, it.entries);
      } else if (it.kind === "attachment") {
        this.attachments.set(it.name, it.data);
        if (it.name === "mission/mission.toml") this.layers.mission = new TextDecoder().decode(it.data);
      } else {
        this.facts(bytes);
        const batch = this.chunk(it.piece, it.messages);
        const readBytes = Number(it.piece.offset + it.piece.length);
        this.tell({ kind: "batch", batch, planes: this.layers.names(), readBytes });
      }
    }
    this.facts(bytes);
    this.tell({
      kind: "end",
      wholeness: this.wholeness(step.value, bytes),
      run: this.run,
      topics: [...this.counts.values()].sort((a, b) => a.topic.localeCompare(b.topic)),
      planes: this.layers.names(),
      checks: this.container.checks,
    });
  }

  /** The bytes of an attachment; nothing if there is none of this name. */
  attachment(name: string): Uint8Array | undefined {
    return this.attachments.get(name);
  }

  /** A plane as it was at a decision; `undefined` if the log does not hold it. */
  plane(id: string, decision: number): Promise<Plane | undefined> {
    return this.layers.plane(id, decision);
  }

  /** The hillshade of a plane. */
  relief(id: string, decision: number): Promise<Relief | undefined> {
    return this.layers.relief(id, decision);
  }

  private metadata(name: string, entries: Map<string, string>): void {
    for (const [key, value] of entries) this.run[name === "wisdom.end" ? `end.${key}` : key] = value;
    if (name === "wisdom.end") this.ended = true;
    if (name === "wisdom.run") {
      const number = (key: string): number => Number(entries.get(key) ?? "0") || 0;
      const side = (key: string): number => (Number.isInteger(number(key)) && number(key) > 0 && number(key) <= LONGEST_SIDE ? number(key) : 0);
      this.layers.grid = {
        rows: side("grid_rows"),
        cols: side("grid_cols"),
        spacingM: number("grid_spacing_m") || 1,
        westM: number("grid_west_m"),
        northM: number("grid_north_m"),
      };
    }
  }

  private facts(bytes: number): void {
    if (this.told) return;
    this.told = true;
    const nowhere: GridSpec = { rows: 0, cols: 0, spacingM: 1, westM: 0, northM: 0 };
    this.layers.grid ??= nowhere;
    this.tell({
      kind: "facts",
      facts: {
        name: this.source.name,
        bytes,
        run: { ...this.run },
        grid: this.layers.grid,
        attachments: [...this.attachments].map(([name, data]) => ({ name, bytes: data.byteLength })),
        experts: experts(this.layers.mission),
        identityRadiusM: identityRadiusM(this.layers.mission),
        hysteresis: hysteresis(this.layers.mission, this.run.overrides ?? ""),
        weights: weights(this.layers.mission, this.run.overrides ?? ""),
      },
    });
  }

  private wholeness(end: End, bytes: number): Wholeness {
    const saved = `${this.decisions} decision${this.decisions === 1 ? "" : "s"} recovered`;
    const onward = "Made whole again up to there by: wisdom log recover LOG OUT";
    switch (end.kind) {
      case "foreign":
        return { kind: "damaged", at: 0, text: `This is not an MCAP file (${bytes} bytes): ${end.why}.` };
      case "damaged":
        return { kind: "damaged", at: end.at, text: `Damaged at byte ${end.at} of ${bytes}: ${end.why}. ${saved}; ${end.stopped ? `nothing after that byte is shown. ${onward}` : "the rest was read on"}.` };
      case "cut":
        return { kind: "cut", at: end.at, text: `Cut short at byte ${end.at} of ${bytes}: ${end.why}. ${saved}. ${onward}.` };
      case "whole":
        // Of another program's log nothing is known to be missing.
        return this.ended || !("log_version" in this.run) ? { kind: "whole" } : { kind: "unfinished", text: `The file is whole, but the run in it did not end. ${saved}.` };
    }
  }

  private chunk(piece: Piece, messages: readonly Message[]): Batch {
    const batch = emptyBatch();
    for (const one of messages) {
      const channel = this.container.channels.get(one.channelId);
      if (!channel) continue;
      const count = this.count(channel, one.data.byteLength);
      try {
        this.take(channel, one, piece, batch);
      } catch (error) {
        // Another program's topic of the same name, or a record that is none: said, and gone past.
        count.unread += 1;
        count.why ||= error instanceof Error ? error.message : String(error);
      }
    }
    return batch;
  }

  private count({ topic, schemaId }: Channel, bytes: number): TopicCount {
    const known = KNOWN.has(topic) || REDUNDANT.has(topic) || topic.startsWith("/map/");
    const schema = this.container.schemas.get(schemaId)?.name ?? "";
    const count = this.counts.get(topic) ?? { topic, schema, count: 0, bytes: 0, known, unread: 0, why: "" };
    this.counts.set(topic, count);
    count.count += 1;
    count.bytes += bytes;
    return count;
  }

  private take(channel: Channel, one: Message, piece: Piece, batch: Batch): void {
    const { topic } = channel;
    const timeS = seconds(one.logTime);
    if (topic.startsWith("/map/")) {
      this.layers.noteGrid(topic, one, piece);
      return;
    }
    if (!KNOWN.has(topic)) return;
    const fields = (without: readonly string[] = []): Fields => this.decoder(channel, without).decode(one.data);
    switch (topic) {
      case "/decision":
        batch.moments.push(moment(fields()));
        this.decisions += 1;
        break;
      case "/in/outcome":
        batch.outcomes.push(outcome(fields()));
        break;
      case "/in/observation": {
        const seen = look(fields(READINGS), this.decisions);
        this.layers.noteLook(seen.windows.map(({ layer }) => layer), this.decisions, one, piece);
        batch.looks.push(seen);
        break;
      }
      case "/in/message":
        batch.happenings.push(message(fields(), timeS, this.decisions));
        break;
      case "/truth/fault":
        batch.happenings.push(fault(fields(), this.decisions));
        break;
      case "/log": {
        const line = fields();
        batch.lines.push({ decision: one.sequence, timeS, level: num(line, "level"), text: str(line, "message") });
        break;
      }
    }
  }

  private decoder(channel: Channel, without: readonly string[] = []): Decoder {
    const key = `${channel.schemaId}/${without.join()}`;
    const known = this.decoders.get(key);
    if (known) return known;
    const schema = this.container.schemas.get(channel.schemaId);
    if (!schema) throw new Error(`topic ${channel.topic} has no schema`);
    const made = Decoder.of(schema, without);
    this.decoders.set(key, made);
    return made;
  }
}
