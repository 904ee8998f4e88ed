import { describe, expect, test } from "vitest";

import { keptOrder } from "../src/model/changes";
import { experts, layers } from "../src/model/mission";
import { Knowledge, at, difference, patched, planeOf } from "../src/model/plane";
import type { Plane } from "../src/model/plane";
import { term } from "../src/ui/format";
import { colourTable } from "../src/view/colour";
import { ticks } from "../src/view/family";
import { lightOn } from "../src/view/relief";

const GRID = { rows: 3, cols: 4, spacingM: 2, westM: 0, northM: 6 };
const plane = (row: number, col: number, rows: number, cols: number, values: number[]): Plane => ({ row, col, rows, cols, values: Float32Array.from(values) });

describe("planes", () => {
  test("a Grid's first row is the south, and its corner says which part of the ground it is", () => {
    const data = new Uint8Array(Float32Array.of(1, 2, 3, 4).buffer);
    const made = planeOf({ westM: 4, southM: 2, cellM: 2, cols: 2, rowStride: 8, cellStride: 4, offset: 0, data }, GRID);
    expect(made).toMatchObject({ row: 0, col: 2, rows: 2, cols: 2 });
    expect([...made.values]).toEqual([3, 4, 1, 2]);
  });

  test("a patch covers its own cells and no others", () => {
    const whole = plane(0, 0, 2, 2, [1, 2, 3, 4]);
    expect([...patched(whole, plane(1, 1, 2, 2, [9, 8, 7, 6])).values]).toEqual([1, 2, 3, 9]);
    expect([...whole.values]).toEqual([1, 2, 3, 4]);
  });

  test("differences are of cells, wherever the planes begin", () => {
    const change = difference(plane(1, 1, 1, 2, [5, 6]), plane(0, 0, 2, 2, [0, 0, 0, 2]));
    expect(at(change, { row: 1, col: 1 })).toBe(3);
    expect(at(change, { row: 1, col: 2 })).toBeUndefined();
  });

  test.each([
    ["best", 7, 0.2],
    ["latest", 9, 0.5],
    ["weighted", (7 * 5 + 9 * 2) / 7, 1 / 7],
  ] as const)("a second reading updates by %s", (update, value, doubt) => {
    const known = new Knowledge({ ...GRID, rows: 1, cols: 2 }, update);
    const window = { row: 0, col: 0, rows: 1, cols: 2 };
    known.read(window, [7, 0], [0.2, 1]);
    known.read(window, [9, 0], [0.5, 1]);
    expect(known.values.values[0]).toBeCloseTo(value, 5);
    expect(known.doubt.values[0]).toBeCloseTo(doubt, 5);
    // Nothing was read there.
    expect(at(known.values, { row: 0, col: 1 })).toBeUndefined();
  });
});

test("one goal put first moves itself and no other", () => {
  expect([...keptOrder([1, 2, 3, 4], [4, 1, 2, 3])]).toEqual([1, 2, 3]);
  expect([...keptOrder([1, 2, 3], [7, 1, 3])]).toEqual([1, 3]);
  expect([...keptOrder([], [1])]).toEqual([]);
});

test("the mission names its experts, and how layers are updated and which are of classes", () => {
  const mission = 'experts = ["experts/dem.toml", "experts/warm.toml"]\n[[layer]]\nname = "elevation"\nunit = "m"\n[[layer]]\nname = "heat"\nupdate = "latest"\n[[layer]]\nname = "texture"\nkind = "class"\nclasses = [1, 2, 4]\n[prior]\nunit = "no"\n';
  expect(experts(mission)).toEqual(["dem", "warm"]);
  expect([...layers(mission)]).toEqual([
    ["elevation", { update: "best", unit: "m", classes: [] }],
    ["heat", { update: "latest", unit: "", classes: [] }],
    ["texture", { update: "best", unit: "", classes: [1, 2, 4] }],
  ]);
});

test("terms wear the unit that ends their name", () => {
  expect(term({ name: "energy_j", value: 1_447_197, limit: 1_443_851 })).toBe("energy 1.45 MJ against 1.44 MJ (+3.3 kJ)");
  expect(term({ name: "moved_m", value: 4.472 })).toBe("moved 4.5 m");
  expect(term({ name: "bound", value: undefined })).toBe("bound ∞");
});

test("axes have round numbers", () => {
  expect(ticks(0, 1)).toEqual([0, 0.2, 0.4, 0.6000000000000001, 0.8, 1]);
  expect(ticks(5, 5)).toEqual([5]);
});

describe("light", () => {
  test("falls on slopes that face north-west and not on those that face away", () => {
    // Rising to the south-east faces the north-west.
    expect(lightOn(1, 1)).toBeGreaterThan(lightOn(0, 0));
    expect(lightOn(-1, -1)).toBeLessThan(lightOn(0, 0));
    expect(lightOn(0, 0)).toBeCloseTo(Math.SQRT1_2, 6);
  });
});

test.each(["viridis", "cividis", "stone"] as const)("%s grows lighter all the way", (name) => {
  const colours = colourTable(name);
  const luminance = Array.from({ length: 256 }, (_, i) => 0.2126 * ((colours[3 * i] ?? 0) / 255) ** 2.2 + 0.7152 * ((colours[3 * i + 1] ?? 0) / 255) ** 2.2 + 0.0722 * ((colours[3 * i + 2] ?? 0) / 255) ** 2.2);
  const steps = luminance.slice(1).map((value, i) => value - (luminance[i] ?? 0));
  // Rounding to bytes may step back by less than one part of 255.
  expect(Math.min(...steps)).toBeGreaterThan(-0.004);
  expect((luminance.at(-1) ?? 0) - (luminance[0] ?? 0)).toBeGreaterThan(0.5);
});
