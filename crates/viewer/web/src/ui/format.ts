// Numbers and words as people read them.

import type { Cell, Term, Trigger, Verdict } from "../model/types";

/** Hours and minutes of mission time, to the nearest minute as `wisdom replay` has them: 6:19 h. */
export const clock = (seconds: number): string => {
  const minutes = Math.round(seconds / 60);
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, "0")} h`;
};

/** Three decimals: interest, prizes, masses. */
export const share = (value: number): string => value.toFixed(3);

/** Reliabilities crowd near one: four decimals tell them apart. */
export const chance = (value: number): string => value.toFixed(4);

export const energy = (joules: number): string =>
  Math.abs(joules) >= 1e6 ? `${(joules / 1e6).toFixed(2)} MJ` : `${(joules / 1e3).toFixed(1)} kJ`;

export const metres = (value: number): string => `${value.toFixed(value < 10 ? 1 : 0)} m`;

export const bytes = (value: number): string =>
  value >= 1e6 ? `${(value / 1e6).toFixed(1)} MB` : value >= 1e3 ? `${(value / 1e3).toFixed(0)} kB` : `${value} B`;

export const place = ({ row, col }: Cell): string => `(${row}, ${col})`;

export const goalName = (id: number): string => `G${id}`;

/** A number of unknown size, with its sign of life kept. */
export const plain = (value: number): string => {
  const size = Math.abs(value);
  if (value === 0) return "0";
  if (size >= 1e5) return value.toExponential(3).replace("e+", "e");
  if (size >= 100) return value.toFixed(0);
  if (size >= 1) return value.toFixed(2);
  if (size >= 1e-3) return value.toFixed(4);
  return value.toExponential(1);
};

/** A term with the unit that ends its name: `energy_j` is in joules. */
export const term = ({ name, value, limit }: Term): string => {
  const written = (number: number | undefined): string => {
    if (number === undefined) return "∞";
    if (name.endsWith("_j")) return energy(number);
    if (name.endsWith("_s")) return clock(number);
    if (name.endsWith("_m")) return metres(number);
    if (name.endsWith("_mb")) return `${number.toFixed(0)} MB`;
    return plain(number);
  };
  const words = name.replace(/_(j|s|m|mb)$/, "").replaceAll("_", " ");
  return limit === undefined ? `${words} ${written(value)}` : `${words} ${written(value)} against ${written(limit)}`;
};

/** Why, with the numbers: "energy: energy 1.45 MJ against 1.44 MJ". */
export const reason = (verdict: Verdict): string => {
  const other = verdict.other === undefined ? "" : ` ${goalName(verdict.other)}`;
  // Interest and prize stand in columns of their own.
  const told = verdict.terms.filter(({ name, limit }) => limit !== undefined || (name !== "interest" && name !== "prize"));
  const terms = told.map(term).join(", ");
  return terms ? `${verdict.reason}${other}: ${terms}` : `${verdict.reason}${other}`;
};

/** A trigger in words. */
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
      return `${name} ${plain(value)}`;
    });
  const moved = before !== undefined && after !== undefined ? ` ${share(before)} → ${share(after)}` : "";
  return `${of.name}${goal}${cell}${moved}${rest.length ? `, ${rest.join(", ")}` : ""}`;
};

/** A field of a CSV file (RFC 4180), quoted where it must be. */
export const csvField = (value: string | number | undefined): string => {
  const text = value === undefined ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};
