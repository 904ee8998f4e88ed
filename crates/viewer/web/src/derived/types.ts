// What the Rust side works out of a log: planes that the log holds only as digests, exact shares at a cell, the ways of a
// family's plans, and prices.

import type { Plane } from "../model/plane";
import type { Cell, PlaneClass, Term } from "../model/types";

/** What a plane is about; planes are offered by it. */
export type Group = "interest" | "layer" | "uncertainty" | "ground" | "mass" | "credit";

export interface DerivedPlane {
  name: string;
  label: string;
  unit: string;
  group: Group;
  classes: PlaneClass[];
}

/** What there is, and whether it is inside the page already; or why there is none. */
export type Index = { planes: DerivedPlane[]; experts: string[]; inside?: boolean } | { unavailable: string };

export interface Masses {
  interesting: number;
  notInteresting: number;
  ignorance: number;
  paradox: number;
}

/** What one expert says at a cell, and its share in Bel(I) there; no share where the interest is that of ignorance. */
export interface ExpertAt {
  name: string;
  masses: Masses | undefined;
  credit: number | undefined;
}

export interface CellValues {
  /** By the planes' names; what is not known is left out. */
  planes: ReadonlyMap<string, number>;
  experts: ExpertAt[];
}

/** The least change that would bring a goal in, or why there is none. */
export type Price =
  | { kind: "least"; least: number; exact: boolean; confirmed: boolean | undefined }
  | { kind: "nothing"; why: string; exact: boolean; terms: Term[] }
  | { kind: "unknown" };

/** What it would have taken to bring a goal in. */
export interface PriceTag {
  /** As the log names it: `G7`. */
  goal: string;
  interestWas: number | undefined;
  energyJ: Price;
  timeS: Price;
  /** The floor under the reliability. */
  reliability: Price;
  prize: Price;
  /** The interest that this prize asks for; above one it cannot be had. */
  interest: number | undefined;
  /** The best plan that would hold it; none if none is known. */
  withIt: WithIt | undefined;
}

/** A plan with a goal that was left out. */
export interface WithIt {
  /** Goals by their names, in their order. */
  order: string[];
  displaced: string[];
  value: number;
  reliability: number;
  timeS: number;
  energyJ: number;
  /** What must be had more of for it: `energy`, `time` or `reliability`. */
  lever: string | undefined;
}

/** What a decision had left, where it is told. */
export interface Limits {
  energyJ: number | undefined;
  timeS: number | undefined;
  minReliability: number | undefined;
}

export interface Prices {
  limits: Limits;
  tags: PriceTag[];
}

/** A source of derived values. What it does not have is `undefined`; what went wrong is an error. */
export interface Derived {
  index(): Promise<Index>;
  plane(name: string, decision: number): Promise<Plane | undefined>;
  cell(decision: number, cell: Cell, signal: AbortSignal): Promise<CellValues | undefined>;
  /** The whole way of each member of the family, in its order. */
  family(decision: number): Promise<readonly (readonly Cell[])[] | undefined>;
  prices(decision: number): Promise<Prices | undefined>;
}
