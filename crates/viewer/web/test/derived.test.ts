import { describe, expect, test } from "vitest";

import { cellOf, familyOf, indexOf, planeOf, pricesOf } from "../src/derived/answers";
import { derivedFrom } from "../src/derived/source";
import { at } from "../src/model/plane";
import type { Plane } from "../src/model/plane";
import { priceLines } from "../src/ui/prices";

const plane = (head: readonly [number, number, number, number], values: readonly number[]): ArrayBuffer => {
  const bytes = new DataView(new ArrayBuffer(16 + 4 * values.length));
  head.forEach((word, i) => bytes.setUint32(4 * i, word, true));
  values.forEach((value, i) => bytes.setFloat32(16 + 4 * i, value, true));
  return bytes.buffer;
};

describe("an answer of the Rust side", () => {
  test("puts a plane's window where it lies in the grid, north row first", () => {
    const found = planeOf(plane([3, 5, 2, 3], [1, 2, 3, 4, Number.NaN, 6]));
    expect(at(found, { row: 3, col: 5 })).toBe(1);
    expect(at(found, { row: 3, col: 7 })).toBe(3);
    expect(at(found, { row: 4, col: 5 })).toBe(4);
    expect(at(found, { row: 4, col: 6 })).toBeUndefined();
    expect(at(found, { row: 2, col: 5 })).toBeUndefined();
  });

  test("that was cut short is no plane", () => {
    expect(() => planeOf(plane([0, 0, 2, 3], [1, 2, 3]))).toThrow("a plane of 2 × 3 cells has 28 bytes, not 40");
    expect(() => planeOf(new ArrayBuffer(7))).toThrow("7 bytes");
  });

  test("gives masses and credits as they are, and leaves out what is null", () => {
    const found = cellOf({
      planes: { ignorance: 0.125, reliability: null },
      experts: [
        { name: "texture", masses: { interesting: 0.2, not_interesting: 0.1, ignorance: 0.7, paradox: 0 }, credit: 0.31 },
        { name: "dem", masses: { interesting: 0.2, not_interesting: 0.1, ignorance: 0.7, paradox: 0 }, credit: null },
      ],
    });
    expect([...found.planes]).toEqual([["ignorance", 0.125]]);
    expect(found.experts[0]).toEqual({ name: "texture", masses: { interesting: 0.2, notInteresting: 0.1, ignorance: 0.7, paradox: 0 }, credit: 0.31 });
    expect(found.experts[1]?.credit).toBeUndefined();
  });

  test("of any other shape is empty and no fault of the page", () => {
    for (const odd of [undefined, null, 7, "x", [], { planes: 3, experts: "no", plans: [[1]], left_out: [null] }]) {
      expect(indexOf(odd)).toEqual({ planes: [], experts: [] });
      expect(cellOf(odd).planes.size).toBe(0);
      expect(familyOf(odd).flat()).toEqual([]);
      expect(pricesOf(odd).limits).toEqual({ energyJ: undefined, timeS: undefined, minReliability: undefined });
    }
  });

  test("names each plane's unit, but not that it has none", () => {
    const found = indexOf({ planes: [{ name: "hazard", unit: "1/m", group: "ground" }, { name: "prize", unit: "1", group: "interest" }], experts: [] });
    expect("planes" in found && found.planes.map(({ unit }) => unit)).toEqual(["1/m", ""]);
  });

  test("says why there are no derived layers", () => {
    expect(indexOf({ unavailable: "decisions of version 4" })).toEqual({ unavailable: "decisions of version 4" });
  });
});

describe("prices", () => {
  const prices = pricesOf({
    limits: { energy_j: 250_000, time_s: 40_000, min_reliability: 0.5 },
    left_out: [
      {
        goal: "G0",
        interest: 0.9961,
        price: {
          energy_j: { least: 89_713.888, exact: true, confirmed: true },
          time_s: { nothing: "outweighed", exact: true, terms: [{ name: "value with it", value: 0.996, limit: 1.875 }] },
          reliability: { nothing: "outweighed", exact: true, terms: [{ name: "value with it", value: 0.996, limit: 1.875 }] },
          prize: { least: 0.8838, exact: false, confirmed: false },
          interest: 1.88,
        },
      },
      { goal: "G1", interest: 0.8, price: { energy_j: { unknown: true }, time_s: { nothing: "beyond-exact", exact: false, terms: [{ name: "bound", value: 0.29, limit: null }] }, reliability: { least: 0.01, exact: true, confirmed: null }, prize: { least: 0.05, exact: true, confirmed: true }, interest: 0.85 } },
    ],
  });
  const [first, second] = prices.tags;

  test("are told in the words of wisdom explain, and what is the same but once", () => {
    expect(first && priceLines(first, prices.limits)).toEqual([
      { levers: "energy", words: "89.7 kJ more (339.7 kJ instead of 250.0 kJ); applied: it is in, and out at 1 % less" },
      { levers: "time, floor", words: "none does it: other goals are worth more; value with it 0.9960 against 1.88 (−0.8790)" },
      { levers: "interest", words: "prize 0.8838 higher: more than an interest of 1 is worth here, the least of those tried; applied: NOT CONFIRMED" },
    ]);
  });

  test("that are not known, not proven or not applied say so", () => {
    expect(second && priceLines(second, prices.limits).map(({ words }) => words)).toEqual([
      "unknown: the search for it ended first",
      "none that was tried does it: it was not among the goals sequenced; bound 0.2900",
      "reliability floor 0.0100 lower (0.4900 instead of 0.5000)",
      "0.8500 instead of 0.8000 (prize 0.0500 higher); applied: it is in, and out at 1 % less",
    ]);
  });
});

describe("a page with the derived parts inside", () => {
  const of = (value: number): Plane => ({ row: 0, col: 0, rows: 1, cols: 2, values: Float32Array.of(value, Number.NaN) });
  const logged: Record<string, Plane> = {
    ignorance: of(0.5),
    "mass-interesting-dem": of(0.25),
    "mass-not-interesting-dem": of(0.125),
    "mass-ignorance-dem": of(0.5),
    "mass-paradox-dem": of(0.125),
    "credit-dem": of(-0.75),
  };
  const planes = Object.keys(logged).map((name) => ({ name, label: name, unit: "", group: "interest" }));
  const block = { index: { planes, experts: ["dem", "texture"] }, families: { 3: { plans: [{ cells: [[1, 2], [1, 3]] }] } } };
  const source = derivedFrom({ kind: "embedded", block }, { at: (name) => Promise.resolve(logged[name]) });
  const signal = new AbortController().signal;

  test("reads a cell's masses and credits from the planes", async () => {
    const found = await source.cell(3, { row: 0, col: 0 }, signal);
    expect(found?.experts).toEqual([{ name: "dem", masses: { interesting: 0.25, notInteresting: 0.125, ignorance: 0.5, paradox: 0.125 }, credit: -0.75 }]);
    expect(found?.planes.get("ignorance")).toBe(0.5);
    const beside = await source.cell(3, { row: 0, col: 1 }, signal);
    expect(beside?.experts).toEqual([{ name: "dem", masses: undefined, credit: undefined }]);
  });

  test("has the ways of those decisions that were put in, and of no others", async () => {
    expect(await source.family(3)).toEqual([[{ row: 1, col: 2 }, { row: 1, col: 3 }]]);
    expect(await source.family(4)).toBeUndefined();
    expect(await source.prices(3)).toBeUndefined();
  });

  test("and one with none has nothing, and says so", async () => {
    const none = derivedFrom({ kind: "none" }, undefined);
    expect(await none.index()).toEqual({ unavailable: "" });
    const noPlanes = derivedFrom({ kind: "embedded", block }, undefined);
    expect(await noPlanes.index()).toEqual({ planes: [], experts: ["dem", "texture"], inside: true });
    expect(await noPlanes.family(3)).toHaveLength(1);
    const another = derivedFrom({ kind: "embedded", block: { index: { unavailable: "decisions of version 4" } } }, undefined);
    expect(await another.index()).toEqual({ unavailable: "decisions of version 4" });
    expect(await none.cell(0, { row: 0, col: 0 }, signal)).toBeUndefined();
    expect(await none.family(0)).toBeUndefined();
  });
});
