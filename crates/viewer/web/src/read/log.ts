// A log being read: what was found, told in batches, and planes made on request.

import { experts, identityRadiusM, layers } from "../model/mission";
import { Knowledge, patched, planeOf } from "../model/plane";
import type { Plane } from "../model/plane";
import type { GridSpec, PlaneName, TopicCount, Wholeness } from "../model/types";
import { relief } from "../view/relief";
import type { Relief } from "../view/relief";
import { Container } from "./container";
import type { Channel, End, Message, Piece } from "./container";
import { Decoder, fault, list, look, message, moment, num, outcome, str, sub } from "./decode";
import type { Fields } from "./decode";
import type { Batch, Tell } from "./protocol";
import type { Source } from "./source";

/** Topics that this page reads; `/map/*` besides. Others are counted and listed. */
const KNOWN = new Set(["/in/observation", "/in/outcome", "/in/message", "/truth/fault", "/decision", "/log"]);
/** Said by other topics too: drawn from the decisions themselves. */
const REDUNDANT = new Set(["/scene", "/rover/pose", "/tf", "/terrain/interest"]);
/** Planes kept decoded: of a large run a few megabytes each. */
const KEPT_PLANES = 24;
/** Readings of layers are wanted by few, and are most of the bytes: a look is decoded without them at first. */
const READINGS = ["LayerWindow.values", "LayerWindow.uncertainty"];

/** Where a Grid message lies. */
interface GridPlace {
  decision: number;
  piece: Piece;
  time: bigint;
  patch: boolean;
}

interface LookPlace {
  decision: number;
  piece: Piece;
  time: bigint;
}

/** Looks that lie in one chunk, together. */
const byPiece = (looks: readonly LookPlace[]): LookPlace[][] => {
  const groups = new Map<bigint, LookPlace[]>();
  for (const look of looks) {
    const group = groups.get(look.piece.offset) ?? [];
    groups.set(look.piece.offset, group);
    group.push(look);
  }
  return [...groups.values()];
};

const emptyBatch = (): Batch => ({ moments: [], outcomes: [], looks: [], happenings: [], lines: [] });

const seconds = (ns: bigint): number => Number(ns / 1000n) / 1e6;

export class LogReader {
  private readonly container: Container;
  private readonly decoders = new Map<string, Decoder>();
  private readonly grids = new Map<string, GridPlace[]>();
  private readonly lookPlaces: LookPlace[] = [];
  private readonly layerNames = new Set<string>();
  private readonly attachments = new Map<string, Uint8Array>();
  private readonly counts = new Map<string, TopicCount>();
  private readonly planes = new Map<string, Plane>();
  private known: { layers: Map<string, Knowledge>; upTo: number } = { layers: new Map(), upTo: -1 };
  private readonly run: Record<string, string> = {};
  private grid: GridSpec | undefined;
  private mission = "";
  private decisions = 0;
  private ended = false;
  private told = false;

  constructor(
    private readonly source: Source,
    private readonly tell: (tell: Tell) => void,
  ) {
    this.container = new Container(source);
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
        this.attachments.set(it.name, it.data ?? new Uint8Array());
        if (it.name === "mission/mission.toml") this.mission = this.attachmentText(it.name) ?? "";
      } else {
        this.facts(bytes);
        const batch = this.chunk(it.piece, it.messages);
        const readBytes = Number(it.piece.offset + it.piece.length);
        this.tell({ kind: "batch", batch, planes: this.planeNames(), readBytes });
      }
    }
    this.facts(bytes);
    this.tell({
      kind: "end",
      wholeness: this.wholeness(step.value, bytes),
      run: this.run,
      topics: [...this.counts.values()].sort((a, b) => a.topic.localeCompare(b.topic)),
      planes: this.planeNames(),
    });
  }

  attachmentText(name: string): string | undefined {
    const bytes = this.attachments.get(name);
    return bytes && new TextDecoder().decode(bytes);
  }

  /** A plane as it was at a decision; `undefined` if the log does not hold it. */
  async plane(id: string, decision: number): Promise<Plane | undefined> {
    const [kind, name] = [id.slice(0, id.indexOf(":")), id.slice(id.indexOf(":") + 1)];
    if (kind === "map") return this.map(name, decision);
    const known = await this.readings(name, decision);
    const plane = kind === "read" ? known?.values : known?.doubt;
    return plane && { ...plane, values: plane.values.slice() };
  }

  /** The hillshade of a plane, made here because it takes longer than a frame. */
  async relief(id: string, decision: number): Promise<Relief | undefined> {
    const plane = await this.plane(id, decision);
    return plane && this.grid && relief(plane, this.grid.spacingM);
  }

  private metadata(name: string, entries: Map<string, string>): void {
    for (const [key, value] of entries) this.run[name === "wisdom.end" ? `end.${key}` : key] = value;
    if (name === "wisdom.end") this.ended = true;
    if (name === "wisdom.run") {
      const number = (key: string): number => Number(entries.get(key) ?? "0") || 0;
      this.grid = {
        rows: number("grid_rows"),
        cols: number("grid_cols"),
        spacingM: number("grid_spacing_m") || 1,
        westM: number("grid_west_m"),
        northM: number("grid_north_m"),
      };
    }
  }

  private facts(bytes: number): void {
    if (this.told) return;
    this.told = true;
    this.grid ??= { rows: 0, cols: 0, spacingM: 1, westM: 0, northM: 0 };
    this.tell({
      kind: "facts",
      facts: {
        name: this.source.name,
        bytes,
        run: { ...this.run },
        grid: this.grid,
        attachments: [...this.attachments].map(([name, data]) => ({ name, bytes: data.byteLength })),
        experts: experts(this.mission),
        identityRadiusM: identityRadiusM(this.mission),
      },
    });
  }

  private wholeness(end: End, bytes: number): Wholeness {
    const saved = `${this.decisions} decision${this.decisions === 1 ? "" : "s"} recovered`;
    if (end.kind === "damaged") {
      return { kind: "damaged", at: end.at, text: `Damaged at byte ${end.at} of ${bytes}: ${end.why}. ${saved}; nothing after that byte is shown.` };
    }
    if (end.kind === "cut") {
      return { kind: "cut", at: end.at, text: `Cut short at byte ${end.at} of ${bytes}: ${end.why}. ${saved}.` };
    }
    if (!this.ended) return { kind: "unfinished", text: `The file is whole, but the run in it did not end. ${saved}.` };
    return { kind: "whole" };
  }

  private chunk(piece: Piece, messages: readonly Message[]): Batch {
    const batch = emptyBatch();
    for (const one of messages) {
      const channel = this.container.channels.get(one.channelId);
      if (!channel) continue;
      this.count(channel, one.data.byteLength);
      this.take(channel, one, piece, batch);
    }
    return batch;
  }

  private count(channel: Channel, bytes: number): void {
    const { topic } = channel;
    const known = KNOWN.has(topic) || REDUNDANT.has(topic) || topic.startsWith("/map/");
    const schema = this.container.schemas.get(channel.schemaId)?.name ?? "";
    const count = this.counts.get(topic) ?? { topic, schema, count: 0, bytes: 0, known };
    this.counts.set(topic, { ...count, count: count.count + 1, bytes: count.bytes + bytes });
  }

  private take(channel: Channel, one: Message, piece: Piece, batch: Batch): void {
    const { topic } = channel;
    const timeS = seconds(one.logTime);
    if (topic.startsWith("/map/")) {
      const patch = topic.endsWith("/patch");
      const name = topic.slice("/map/".length, patch ? -"/patch".length : undefined);
      const places = this.grids.get(name) ?? [];
      this.grids.set(name, places);
      places.push({ decision: one.sequence, piece, time: one.logTime, patch });
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
        for (const { layer } of seen.windows) this.layerNames.add(layer);
        if (seen.windows.length > 0) this.lookPlaces.push({ decision: this.decisions, piece, time: one.logTime });
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

  private planeNames(): PlaneName[] {
    const facts = layers(this.mission);
    const unit = (layer: string): string => facts.get(layer)?.unit ?? "";
    const maps = [...this.grids.keys()].map((name) => ({ id: `map:${name}`, label: name === "elevation" ? "elevation, as first known" : name, unit: unit(name) }));
    const read = [...this.layerNames].flatMap((name): PlaneName[] => {
      const classes = facts.get(name)?.classes.map((value) => ({ value, name: String(value) })) ?? [];
      return [
        { id: `read:${name}`, label: `${name} as read`, unit: unit(name), classes },
        { id: `doubt:${name}`, label: `uncertainty of ${name} as read` },
      ];
    });
    return [...maps, ...read];
  }

  /** The last whole map, and the patches since. */
  private async map(name: string, decision: number): Promise<Plane | undefined> {
    const places = (this.grids.get(name) ?? []).filter((place) => place.decision <= decision);
    const last = places.at(-1);
    const first = places.findLastIndex((place) => !place.patch);
    if (!last || first < 0) return undefined;
    const key = `${name}@${last.time}`;
    const known = this.planes.get(key);
    if (known) return known;
    // The map of the decision before is likely at hand: then only the last patch is new.
    const before = last.patch ? this.planes.get(`${name}@${places.at(-2)?.time}`) : undefined;
    let plane = before;
    for (const place of before ? [last] : places.slice(first)) {
      const found = await this.gridAt(place);
      plane = place.patch && plane ? patched(plane, found) : found;
    }
    if (plane) this.keep(key, plane);
    return plane;
  }

  private keep(key: string, plane: Plane): void {
    this.planes.set(key, plane);
    const oldest = this.planes.keys().next().value;
    if (this.planes.size > KEPT_PLANES && oldest !== undefined) this.planes.delete(oldest);
  }

  private async gridAt(place: GridPlace): Promise<Plane> {
    const found = (await this.container.messages(place.piece)).find((one) => one.logTime === place.time);
    const channel = found && this.container.channels.get(found.channelId);
    if (!found || !channel || !this.grid) throw new Error(`the map of decision ${place.decision} is not where it was`);
    const fields = this.decoder(channel).decode(found.data);
    const corner = sub(sub(fields, "pose"), "position");
    const field = list(fields, "fields")[0];
    return planeOf(
      {
        westM: num(corner, "x"),
        southM: num(corner, "y"),
        cellM: num(sub(fields, "cellSize"), "x"),
        cols: num(fields, "columnCount"),
        rowStride: num(fields, "rowStride"),
        cellStride: num(fields, "cellStride"),
        offset: field ? num(field, "offset") : 0,
        data: fields.data as Uint8Array,
      },
      this.grid,
    );
  }

  /** What is known of a layer at a decision: all its readings until then, put together as the mission says. */
  private async readings(layer: string, decision: number): Promise<Knowledge | undefined> {
    if (!this.grid || !this.layerNames.has(layer)) return undefined;
    if (this.known.upTo > decision) this.known = { layers: new Map(), upTo: -1 };
    const { known } = this;
    const unread = this.lookPlaces.filter((look) => look.decision > known.upTo && look.decision <= decision);
    known.upTo = decision;
    for (const places of byPiece(unread)) {
      const messages = places[0] ? await this.container.messages(places[0].piece) : [];
      for (const { time } of places) this.learn(messages.find(({ logTime }) => logTime === time));
    }
    return known.layers.get(layer);
  }

  /** Takes in a look: all its layers at once, because finding them is most of the work. */
  private learn(found: Message | undefined): void {
    const channel = found && this.container.channels.get(found.channelId);
    if (!found || !channel || !this.grid) return;
    for (const window of list(this.decoder(channel).decode(found.data), "windows")) {
      const name = str(window, "layer");
      const knowledge = this.known.layers.get(name) ?? new Knowledge(this.grid, layers(this.mission).get(name)?.update ?? "best");
      this.known.layers.set(name, knowledge);
      const place = { row: num(window, "row"), col: num(window, "col"), rows: num(window, "rows"), cols: num(window, "cols") };
      knowledge.read(place, window.values as number[], window.uncertainty as number[]);
    }
  }
}
