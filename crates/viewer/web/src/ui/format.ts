// Numbers and words as people read them.

import type { Cell, Term, Trigger, Verdict } from "../model/types";
import { apart, excess } from "./compared";
import type { Writer } from "./compared";

/** Hours and minutes of mission time, to the nearest minute as `wisdom replay` has them: 6:19 h. */
export const clock = (seconds: number, more = 0): string => {
  if (more > 0) return `${seconds.toFixed(more - 1)} s`;
  const minutes = Math.round(seconds / 60);
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")} h`;
};

/** Three decimals: interest, prizes, masses. */
export const share = (value: number, more = 0): string => value.toFixed(3 + more);

/** Reliabilities crowd near one: four decimals tell them apart. */
export const chance = (value: number, more = 0): string => value.toFixed(4 + more);

export const energy = (joules: number, more = 0): string =>
  Math.abs(joules) >= 1e6 ? `${(joules / 1e6).toFixed(2 + more)} MJ` : `${(joules / 1e3).toFixed(1 + more)} kJ`;

export const metres = (value: number, more = 0): string => `${value.toFixed((value < 10 ? 1 : 0) + more)} m`;

export const volume = (megabytes: number, more = 0): string => `${megabytes.toFixed(more)} MB`;

export const bytes = (value: number): string =>
  value >= 1e6 ? `${(value / 1e6).toFixed(1)} MB` : value >= 1e3 ? `${(value / 1e3).toFixed(0)} kB` : `${value} B`;

export const place = ({ row, col }: Cell): string => `(${row}, ${col})`;

export const goalName = (id: number): string => `G${id}`;

/** A number of unknown size, with its sign of life kept. */
export const plain = (value: number, more = 0): string => {
  const size = Math.abs(value);
  if (value === 0) return "0";
  if (size >= 1e5) return value.toExponential(3 + more).replace("e+", "e");
  if (size >= 100) return value.toFixed(more);
  if (size >= 1) return value.toFixed(2 + more);
  if (size >= 1e-3) return value.toFixed(4 + more);
  return value.toExponential(1 + more);
};

/** A number beside another, and how far it is from that: 8.527 (−0.0061). */
export const against = (value: number, other: number, write: Writer): string => `${apart(value, other, write)[0]} (${excess(value, other, write)})`;

/** `0.291 → 0.141 (−0.150)` */
export const fromTo = (before: number, after: number, write: Writer): string => `${apart(before, after, write).join(" → ")} (${excess(after, before, write)})`;

const UNITS: readonly [string, Writer][] = [
  ["_j", energy],
  ["_s", clock],
  ["_m", metres],
  ["_mb", volume],
];

/** Tries, poses and other things that are counted. */
const counted = (value: number | undefined): boolean => value === undefined || Number.isInteger(value);

/**
 * A term with the unit that ends its name: `energy_j` is in joules. Numbers compared are written in as many digits as
 * tell them apart, with the difference.
 */
export const term = ({ name, value, limit }: Term): string => {
  const words = name.replace(/_(j|s|m|mb)$/, "").replaceAll("_", " ");
  const unit = UNITS.find(([ending]) => name.endsWith(ending))?.[1];
  const whole = unit === undefined && counted(value) && counted(limit);
  const write: Writer = unit ?? (whole ? String : plain);
  const written = (number: number | undefined): string => (number === undefined ? "∞" : write(number));
  if (limit === undefined) return `${words} ${written(value)}`;
  if (value === undefined || whole) return `${words} ${written(value)} against ${written(limit)}`;
  const [one, other] = apart(value, limit, write);
  return `${words} ${one} against ${other} (${excess(value, limit, write)})`;
};

/** Some reasons compare prizes of the map, before the directive's weight: the same word would be another number. */
const UNWEIGHTED: ReadonlySet<string> = new Set(["explained", "merged"]);

/** A term of a reason, so named that a prize with its weight and one without are told apart. */
export const termOf = (code: string, of: Term): string => {
  const bare = of.name === "prize at the old target" || (of.name === "prize" && of.limit !== undefined && UNWEIGHTED.has(code));
  return term(bare ? { ...of, name: `unweighted ${of.name}` } : of);
};

/** Why, with the numbers: "energy: energy 1.45 MJ against 1.44 MJ (+3.3 kJ)". */
export const reason = (verdict: Verdict): string => {
  const other = verdict.other === undefined ? "" : ` ${goalName(verdict.other)}`;
  // Interest and prize stand in columns of their own.
  const told = verdict.terms.filter(({ name, limit }) => limit !== undefined || (name !== "interest" && name !== "prize"));
  const terms = told.map((one) => termOf(verdict.reason, one)).join(", ");
  return terms ? `${verdict.reason}${other}: ${terms}` : `${verdict.reason}${other}`;
};

/** A trigger in words, each number by its name. */
export const trigger = (of: Trigger): string => {
  const number = (name: string): number | undefined => of.numbers.find((one) => one.name === name)?.value;
  const goal = of.goal === undefined ? "" : ` ${goalName(of.goal)}`;
  const cell = of.cell ? ` at ${place(of.cell)}` : "";
  const [before, after] = [number("before"), number("after")];
  const rest = of.numbers
    .filter(({ name }) => name !== "before" && name !== "after")
    .map(({ name, value }) => {
      if (name === "share") return `${value > 0 ? "+" : "−"}${Math.abs(100 * value).toFixed(0)} % energy`;
      if (name === "seconds") return clock(value);
      if (name === "message") return `message ${value}`;
      return `${name} ${plain(value)}`;
    });
  // The log's `before` and `after` are prizes, the directive's weight in them; of a conflict what two experts say against each other.
  const what = of.name === "conflict" ? "contradiction" : "prize";
  const moved = before !== undefined && after !== undefined ? ` ${what} ${fromTo(before, after, share)}` : "";
  return `${of.name}${goal}${cell}${moved}${rest.length ? `, ${rest.join(", ")}` : ""}`;
};

/** A field of a CSV file (RFC 4180), quoted where it must be. */
export const csvField = (value: string | number | undefined): string => {
  const text = value === undefined ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};
