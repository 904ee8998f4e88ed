// The maps in a log: where they lie, and how they are put together when one is looked at.

import { layers } from "../model/mission";
import { Knowledge, patched, planeOf } from "../model/plane";
import type { Plane } from "../model/plane";
import type { GridSpec, PlaneName } from "../model/types";
import { relief } from "../view/relief";
import type { Relief } from "../view/relief";
import type { Channel, Container, Message, Piece } from "./container";
import { list, num, str, sub } from "./decode";
import type { Decoder } from "./decode";

/** Planes kept decoded: of a large run a few megabytes each. */
const KEPT_PLANES = 24;

/** Where a Grid message lies. */
interface GridPlace extends Place {
  patch: boolean;
}

/** Where a message lies: a time alone does not name it, because several may be of one time. */
interface Place {
  decision: number;
  piece: Piece;
  channel: number;
  time: bigint;
  sequence: number;
}

type LookPlace = Place;

const placeOf = (decision: number, { channelId, logTime, sequence }: Message, piece: Piece): Place => ({ decision, piece, channel: channelId, time: logTime, sequence });

/** The message of a place, among those of its piece. */
const messageAt = (messages: readonly Message[], { channel, time, sequence }: Place): Message | undefined =>
  messages.find((one) => one.channelId === channel && one.logTime === time && one.sequence === sequence);

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

/** The latest of these that is no later than a decision: its place among them, or -1. */
const lastAt = (places: readonly GridPlace[], decision: number): number => {
  let [from, to] = [0, places.length];
  while (from < to) {
    const middle = (from + to) >> 1;
    if ((places[middle]?.decision ?? 0) > decision) to = middle;
    else from = middle + 1;
  }
  return from - 1;
};

export class Layers {
  grid: GridSpec | undefined;
  mission = "";
  private readonly grids = new Map<string, GridPlace[]>();
  private readonly lookPlaces: LookPlace[] = [];
  private readonly layerNames = new Set<string>();
  private readonly planes = new Map<string, Plane>();
  private known: { layers: Map<string, Knowledge>; upTo: number } = { layers: new Map(), upTo: -1 };

  constructor(
    private readonly container: Container,
    private readonly decoder: (channel: Channel) => Decoder,
  ) {}

  /** Notes a Grid message on `/map/NAME` or `/map/NAME/patch`. */
  noteGrid(topic: string, one: Message, piece: Piece): void {
    const patch = topic.endsWith("/patch");
    const name = topic.slice("/map/".length, patch ? -"/patch".length : undefined);
    const places = this.grids.get(name) ?? [];
    this.grids.set(name, places);
    places.push({ ...placeOf(one.sequence, one, piece), patch });
  }

  /** Notes a look and the layers that were read in it. */
  noteLook(names: readonly string[], decision: number, one: Message, piece: Piece): void {
    for (const name of names) this.layerNames.add(name);
    if (names.length > 0) this.lookPlaces.push(placeOf(decision, one, piece));
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

  names(): PlaneName[] {
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
    const places = this.grids.get(name) ?? [];
    const end = lastAt(places, decision);
    // Back from there to the nearest map at hand, or to a whole one.
    let from = end;
    let plane: Plane | undefined;
    for (; from >= 0; from--) {
      plane = this.planes.get(`${name}@${from}`);
      if (plane || !places[from]?.patch) break;
    }
    if (from < 0) return undefined;
    const key = `${name}@${end}`;
    for (const place of places.slice(plane ? from + 1 : from, end + 1)) {
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
    const found = messageAt(await this.container.messages(place.piece), place);
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
    try {
      for (const places of byPiece(unread)) {
        const messages = places[0] ? await this.container.messages(places[0].piece) : [];
        for (const place of places) this.learn(messageAt(messages, place));
      }
    } catch (error) {
      // Of the looks some were taken in and some not: begun anew when next asked.
      this.known = { layers: new Map(), upTo: -1 };
      throw error;
    }
    known.upTo = decision;
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
