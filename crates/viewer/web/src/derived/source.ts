// Where derived values come from: the server that handed the page out, or the page itself.

import { at } from "../model/plane";
import type { Plane } from "../model/plane";
import type { Cell } from "../model/types";
import type { Origin } from "../read/protocol";
import { cellOf, familyOf, indexOf, planeOf, pricesOf } from "./answers";
import { member, text } from "./json";
import type { CellValues, Derived, ExpertAt, Index, Masses, Prices } from "./types";

/** What the page was given to find derived values with. */
export type Supply = { kind: "served"; folder: string } | { kind: "embedded"; block: unknown; planes?: Origin } | { kind: "none" };

/** Has planes by their names. */
export interface PlaneSource {
  at(name: string, decision: number): Promise<Plane | undefined>;
}

/** What is inside the page has its planes apart from the rest. */
export const derivedFrom = (supply: Supply, inside: PlaneSource | undefined): Derived => {
  if (supply.kind === "served") return new Served(supply.folder);
  return new Embedded(supply.kind === "embedded" ? supply.block : undefined, inside);
};

/** Asks once, and again only after a failure. */
const once = <T>(kept: Map<string, Promise<T>>, key: string, ask: () => Promise<T>): Promise<T> => {
  const known = kept.get(key);
  if (known) return known;
  const asked = ask();
  kept.set(key, asked);
  asked.catch(() => kept.delete(key));
  return asked;
};

class Served implements Derived {
  private readonly answers = new Map<string, Promise<unknown>>();

  constructor(private readonly folder: string) {}

  async index(): Promise<Index> {
    return indexOf(await this.json("index"));
  }

  plane(name: string, decision: number): Promise<Plane | undefined> {
    return this.ifAny(async () => planeOf(await (await this.get(`plane/${decision}/${encodeURIComponent(name)}`)).arrayBuffer()));
  }

  cell(decision: number, { row, col }: Cell, signal: AbortSignal): Promise<CellValues | undefined> {
    return this.ifAny(async () => cellOf(await (await this.get(`cell/${decision}/${row}/${col}`, signal)).json()));
  }

  family(decision: number): Promise<Cell[][] | undefined> {
    return this.ifAny(async () => familyOf(await this.json(`family/${decision}`)));
  }

  prices(decision: number): Promise<Prices | undefined> {
    return this.ifAny(async () => pricesOf(await this.json(`prices/${decision}`)));
  }

  /** A server that can derive nothing of this log is not asked again. */
  private async ifAny<T>(ask: () => Promise<T>): Promise<T | undefined> {
    return "unavailable" in (await this.index()) ? undefined : ask();
  }

  private json(path: string): Promise<unknown> {
    return once(this.answers, path, async () => (await this.get(path)).json() as Promise<unknown>);
  }

  private async get(path: string, signal?: AbortSignal): Promise<Response> {
    const answer = await fetch(new URL(`${this.folder}/${path}`, location.href), { ...(signal ? { signal } : {}) });
    if (answer.ok) return answer;
    const said = text(member(await answer.json().catch(() => undefined), "error"));
    throw new Error(said ?? `status ${answer.status} for ${path}`);
  }
}

/** Planes lie in a log of their own; all else in a block of the page, which may leave any part out. */
class Embedded implements Derived {
  constructor(
    private readonly block: unknown,
    private readonly inside: PlaneSource | undefined,
  ) {}

  index(): Promise<Index> {
    if (this.block === undefined) return Promise.resolve({ unavailable: "" });
    const index = indexOf(member(this.block, "index"));
    // A page may have ways and prices inside, and no planes.
    return Promise.resolve("unavailable" in index ? index : { ...index, planes: this.inside ? index.planes : [], inside: true });
  }

  plane(name: string, decision: number): Promise<Plane | undefined> {
    return this.inside?.at(name, decision) ?? Promise.resolve(undefined);
  }

  async cell(decision: number, cell: Cell): Promise<CellValues | undefined> {
    const index = await this.index();
    if ("unavailable" in index) return undefined;
    const found = await Promise.all(
      index.planes.map(async ({ name }): Promise<[string, number][]> => {
        const plane = await this.plane(name, decision);
        const value = plane && at(plane, cell);
        return value === undefined ? [] : [[name, value]];
      }),
    );
    const planes = new Map(found.flat());
    const embedded = new Set(index.planes.map(({ name }) => name));
    const experts = index.experts
      .filter((name) => embedded.has(`credit-${name}`) || embedded.has(`mass-interesting-${name}`))
      .map((name): ExpertAt => ({ name, masses: massesAt(planes, name), credit: planes.get(`credit-${name}`) }));
    return { planes, experts };
  }

  family(decision: number): Promise<Cell[][] | undefined> {
    const found = member(member(this.block, "families"), String(decision));
    return Promise.resolve(found === undefined ? undefined : familyOf(found));
  }

  prices(decision: number): Promise<Prices | undefined> {
    const found = member(member(this.block, "prices"), String(decision));
    return Promise.resolve(found === undefined ? undefined : pricesOf(found));
  }
}

const massesAt = (planes: ReadonlyMap<string, number>, expert: string): Masses | undefined => {
  const mass = (of: string): number | undefined => planes.get(`mass-${of}-${expert}`);
  const [interesting, notInteresting, ignorance, paradox] = [mass("interesting"), mass("not-interesting"), mass("ignorance"), mass("paradox")];
  if (interesting === undefined || notInteresting === undefined || ignorance === undefined || paradox === undefined) return undefined;
  return { interesting, notInteresting, ignorance, paradox };
};
