import { describe, expect, test } from "vitest";

import type { Index } from "../src/derived/types";
import { differing } from "../src/model/plane";
import type { Plane } from "../src/model/plane";
import { aspectTitle, choices, className, classesShown, scaleOf } from "../src/page/choices";
import type { Choice } from "../src/page/choices";
import { beyondNote, tickLabels } from "../src/ui/legend";
import { Viewport } from "../src/view/viewport";

const logged = [
  { id: "map:interest", label: "interest", unit: "" },
  { id: "map:elevation", label: "elevation, as first known", unit: "m" },
  { id: "read:texture", label: "texture as read", unit: "", classes: [{ value: 1, name: "1" }] },
  { id: "doubt:texture", label: "uncertainty of texture as read" },
];
const index: Index = {
  experts: ["dem"],
  planes: [
    { name: "interest", label: "interest", unit: "", group: "interest", classes: [] },
    { name: "hazard", label: "hazard", unit: "1/m", group: "interest", classes: [] },
    { name: "elevation", label: "elevation", unit: "m", group: "layer", classes: [] },
    { name: "texture", label: "texture", unit: "", group: "layer", classes: [{ value: 1, name: "sand" }, { value: 2, name: "rock" }] },
    { name: "blocked", label: "where the rover cannot stand", unit: "", group: "ground", classes: [{ value: 0, name: "open" }, { value: 1, name: "blocked" }] },
    { name: "credit-dem", label: "credit of dem", unit: "", group: "credit", classes: [] },
  ],
};
const all = choices(logged, index);
const choice = (id: string): Choice => {
  const found = all.find((one) => one.id === id);
  if (!found) throw new Error(`${id} is not offered`);
  return found;
};
const plane = (...values: number[]): Plane => ({ row: 0, col: 0, rows: 1, cols: values.length, values: Float32Array.from(values) });

describe("the choice of layers", () => {
  test("shows a map of the log rather than its derived twin, but elevation both as known first and as used", () => {
    expect(all.map(({ id }) => id)).toEqual(["map:interest", "derived:hazard", "map:elevation", "read:texture", "derived:elevation", "derived:texture", "doubt:texture", "derived:blocked", "derived:credit-dem"]);
  });

  test("takes maps that were logged besides for what the index says of them", () => {
    const maps = [{ id: "map:interest", label: "interest" }, { id: "map:credit-dem", label: "credit-dem" }];
    const report = choices(maps, index);
    expect(report.find(({ id }) => id === "map:credit-dem")).toMatchObject({ group: "credits", label: "credit of dem" });
    expect(report.some(({ id }) => id === "derived:credit-dem")).toBe(false);
  });

  test("knows the names of classes for readings too", () => {
    expect(choice("read:texture").classes).toEqual([{ value: 1, name: "sand" }, { value: 2, name: "rock" }]);
    expect(choice("doubt:texture").classes).toEqual([]);
    expect(className({ value: 4, name: "class 4" })).toBe("class 4");
    expect(className({ value: 4, name: "rock" })).toBe("4 rock");
    expect(className({ value: 4, name: "4" })).toBe("class 4");
  });

  test("names what it shows, with its unit", () => {
    expect(aspectTitle(choice("derived:elevation"), "between")).toBe("elevation, m: A less B");
    expect(aspectTitle(choice("derived:hazard"), "change")).toBe("change of hazard, 1/m since last");
  });
});

describe("the scale of a layer", () => {
  test("is from nothing to one for shares, whatever is seen of them", () => {
    expect(scaleOf(choice("map:interest"), "value", [plane(0.2, 0.4)], "viridis")).toEqual({ colours: "viridis", min: 0, max: 1 });
    expect(scaleOf(choice("doubt:texture"), "value", [plane(0.2)], "viridis")).toEqual({ colours: "cividis", min: 0, max: 1 });
  });

  test("is diverging about nothing for credits and differences", () => {
    expect(scaleOf(choice("derived:credit-dem"), "value", [plane(0.1)], "viridis")).toEqual({ colours: "diverging", min: -1, max: 1 });
    expect(scaleOf(choice("derived:elevation"), "between", [plane(-3, 2)], "viridis")).toEqual({ colours: "diverging", min: -3, max: 3 });
    expect(scaleOf(choice("map:interest"), "change", [plane(0.001)], "viridis")).toMatchObject({ min: -0.05, max: 0.05 });
  });

  test("is one for both runs", () => {
    expect(scaleOf(choice("derived:hazard"), "value", [plane(1, 2), plane(4, Number.NaN)], "batlow")).toEqual({ colours: "batlow", min: 1, max: 4 });
  });

  test("has nothing between classes, and shows of two runs where they differ", () => {
    expect(scaleOf(choice("derived:texture"), "value", [plane(1, 2)], "viridis").classes).toEqual([1, 2]);
    expect(classesShown(choice("derived:blocked"), "value").map(className)).toEqual(["0 open", "1 blocked"]);
    expect(classesShown(choice("derived:texture"), "between").map(({ name }) => name)).toEqual(["the same", "another"]);
    expect([...differing(plane(1, 2, Number.NaN, 4), plane(1, 3, 3, Number.NaN)).values]).toEqual([0, 1, Number.NaN, Number.NaN]);
  });
});

describe("the viewport", () => {
  const grid = { rows: 100, cols: 100, spacingM: 1, westM: 0, northM: 0 };
  const keep = { left: 280, right: 0, top: 0, bottom: 0 };

  test("keeps clear of the legend where the map gets no smaller for it", () => {
    const wide = new Viewport();
    wide.fit(grid, 1000, 500, keep);
    expect(wide.x).toBeGreaterThanOrEqual(280);
    const narrow = new Viewport();
    narrow.fit(grid, 500, 500, keep);
    expect(narrow.x).toBeLessThan(20);
  });

  test("keeps the cell under the pointer when it zooms", () => {
    const port = new Viewport();
    port.fit(grid, 500, 500, keep);
    const was = port.cellAt(300, 200, grid);
    port.zoom(3, 300, 200);
    expect(port.cellAt(300, 200, grid)).toEqual(was);
    expect(port.cellAt(-1000, 0, grid)).toBeUndefined();
  });
});

describe("credits beyond the ends of their scale", () => {
  const credit = choice("derived:credit-dem");

  test("are told of at the end that they lie beyond, and nowhere else", () => {
    const scale = scaleOf(credit, "value", [plane(-0.3, 1.4517)], "viridis");
    expect(tickLabels(scale)).toEqual(["-1.00", "-0.50", "0.00", "0.50", "≥ 1.00"]);
    expect(beyondNote(scale)).toEqual(["beyond the ends: values from -0.3000 to 1.45"]);
    expect(tickLabels(scaleOf(credit, "value", [plane(0.2), plane(-2)], "viridis"))[0]).toBe("≤ -1.00");
  });

  test("are not told of where there are none", () => {
    const scale = scaleOf(credit, "value", [plane(-1, 1 + 1e-7)], "viridis");
    expect(tickLabels(scale)).toEqual(["-1.00", "-0.50", "0.00", "0.50", "1.00"]);
    expect(beyondNote(scale)).toEqual([]);
  });
});
