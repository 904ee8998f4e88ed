// What the answers of the Rust side say, as records.

import type { Plane } from "../model/plane";
import type { Cell, PlaneClass, Term } from "../model/types";
import { entries, finite, items, member, text } from "./json";
import type { CellValues, ExpertAt, Group, Index, Limits, Masses, Price, PriceTag, Prices, WithIt } from "./types";

const GROUPS: readonly Group[] = ["interest", "layer", "uncertainty", "ground", "mass", "credit"];

export const indexOf = (answer: unknown): Index => {
  const why = text(member(answer, "unavailable"));
  if (why !== undefined) return { unavailable: why };
  const planes = items(member(answer, "planes")).flatMap((one) => {
    const name = text(member(one, "name"));
    if (name === undefined) return [];
    const group = GROUPS.find((known) => known === member(one, "group")) ?? "interest";
    const unit = text(member(one, "unit")) ?? "";
    // What is measured in ones has no unit to be written.
    return [{ name, label: text(member(one, "label")) ?? name, unit: unit === "1" ? "" : unit, group, classes: classesOf(one) }];
  });
  return { planes, experts: items(member(answer, "experts")).flatMap((name) => text(name) ?? []) };
};

const classesOf = (plane: unknown): PlaneClass[] =>
  items(member(plane, "classes")).flatMap((one) => {
    const value = finite(member(one, "value"));
    return value === undefined ? [] : [{ value, name: text(member(one, "name")) ?? String(value) }];
  });

const HEAD_BYTES = 16;

/** A window of the run's grid: row, column, rows and columns, then its values from the north-west. */
export const planeOf = (bytes: ArrayBuffer): Plane => {
  if (bytes.byteLength < HEAD_BYTES) throw new Error(`a plane of ${bytes.byteLength} bytes has no head`);
  const head = new DataView(bytes, 0, HEAD_BYTES);
  const word = (i: number): number => head.getUint32(4 * i, true);
  const [row, col, rows, cols] = [word(0), word(1), word(2), word(3)];
  const told = HEAD_BYTES + 4 * rows * cols;
  if (bytes.byteLength !== told) throw new Error(`a plane of ${rows} × ${cols} cells has ${bytes.byteLength} bytes, not ${told}`);
  const body = new DataView(bytes, HEAD_BYTES);
  const values = new Float32Array(rows * cols);
  for (let i = 0; i < values.length; i++) values[i] = body.getFloat32(4 * i, true);
  return { row, col, rows, cols, values };
};

export const cellOf = (answer: unknown): CellValues => ({
  planes: new Map(
    entries(member(answer, "planes")).flatMap(([name, value]): [string, number][] => {
      const known = finite(value);
      return known === undefined ? [] : [[name, known]];
    }),
  ),
  experts: items(member(answer, "experts")).map(
    (one): ExpertAt => ({ name: text(member(one, "name")) ?? "", masses: massesOf(member(one, "masses")), credit: finite(member(one, "credit")) }),
  ),
});

const massesOf = (answer: unknown): Masses | undefined => {
  const [interesting, notInteresting] = [finite(member(answer, "interesting")), finite(member(answer, "not_interesting"))];
  const [ignorance, paradox] = [finite(member(answer, "ignorance")), finite(member(answer, "paradox"))];
  if (interesting === undefined || notInteresting === undefined || ignorance === undefined || paradox === undefined) return undefined;
  return { interesting, notInteresting, ignorance, paradox };
};

export const familyOf = (answer: unknown): Cell[][] =>
  items(member(answer, "plans")).map((plan) =>
    items(member(plan, "cells")).flatMap((pair) => {
      const [row, col] = items(pair).map(finite);
      return row === undefined || col === undefined ? [] : [{ row, col }];
    }),
  );

const termsOf = (answer: unknown): Term[] =>
  items(answer).map((one) => {
    const [value, limit] = [finite(member(one, "value")), finite(member(one, "limit"))];
    return { name: text(member(one, "name")) ?? "", ...(value === undefined ? {} : { value }), ...(limit === undefined ? {} : { limit }) };
  });

const priceOf = (answer: unknown): Price => {
  const exact = member(answer, "exact") === true;
  const least = finite(member(answer, "least"));
  const confirmed = member(answer, "confirmed");
  if (least !== undefined) return { kind: "least", least, exact, confirmed: typeof confirmed === "boolean" ? confirmed : undefined };
  const why = text(member(answer, "nothing"));
  return why === undefined ? { kind: "unknown" } : { kind: "nothing", why, exact, terms: termsOf(member(answer, "terms")) };
};

const withItOf = (answer: unknown): WithIt | undefined => {
  const [value, reliability] = [finite(member(answer, "value")), finite(member(answer, "reliability"))];
  const [timeS, energyJ] = [finite(member(answer, "time_s")), finite(member(answer, "energy_j"))];
  if (value === undefined || reliability === undefined || timeS === undefined || energyJ === undefined) return undefined;
  const names = (key: string): string[] => items(member(answer, key)).flatMap((name) => text(name) ?? []);
  return { order: names("order"), displaced: names("displaced"), value, reliability, timeS, energyJ, lever: text(member(answer, "lever")) };
};

export const pricesOf = (answer: unknown): Prices => {
  const left = member(answer, "limits");
  const limits: Limits = {
    energyJ: finite(member(left, "energy_j")),
    timeS: finite(member(left, "time_s")),
    minReliability: finite(member(left, "min_reliability")),
  };
  const tags = items(member(answer, "left_out")).map((one): PriceTag => {
    const price = member(one, "price");
    return {
      goal: text(member(one, "goal")) ?? "",
      interestWas: finite(member(one, "interest")),
      energyJ: priceOf(member(price, "energy_j")),
      timeS: priceOf(member(price, "time_s")),
      reliability: priceOf(member(price, "reliability")),
      prize: priceOf(member(price, "prize")),
      interest: finite(member(price, "interest")),
      withIt: withItOf(member(one, "with_it")),
    };
  });
  return { limits, tags };
};
