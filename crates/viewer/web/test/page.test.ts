// Small steps of the page that need no browser.

import { describe, expect, test } from "vitest";

import { nextTurn } from "../src/model/changes";
import type { Life } from "../src/model/lives";
import type { Moment } from "../src/model/types";
import { nextTheme } from "../src/page/theme";
import { laneName } from "../src/view/lanes";

test("the first change of theme is to the opposite of what the system has, and three changes lead back", () => {
  for (const dark of [false, true]) {
    const first = nextTheme("auto", dark);
    expect(first).toBe(dark ? "light" : "dark");
    const second = nextTheme(first, dark);
    expect(second).toBe(dark ? "dark" : "light");
    expect(nextTheme(second, dark)).toBe("auto");
  }
});

describe("the next decision that adds or drops a goal", () => {
  const moments = ["add", "keep", "modify", "drop", "keep"].map((action) => ({ verdicts: [{ action: "keep" }, { action }] }) as unknown as Moment);

  test("is found forward and backward, past those that only keep", () => {
    expect(nextTurn(moments, 0, 1)).toBe(3);
    expect(nextTurn(moments, 4, -1)).toBe(3);
    expect(nextTurn(moments, 3, -1)).toBe(0);
  });

  test("is none after the last and before the first", () => {
    expect(nextTurn(moments, 3, 1)).toBeUndefined();
    expect(nextTurn(moments, 0, -1)).toBeUndefined();
  });
});

test("a lane of two runs says whose goals it is of", () => {
  const life = (goal: number): Life => ({ goal, directive: "image", first: 0, last: 0, stretches: [] }) as unknown as Life;
  expect(laneName({ a: life(6), b: life(4) }, true)).toBe("A G6 · B G4");
  expect(laneName({ a: life(14) }, true)).toBe("A G14");
  expect(laneName({ b: life(15) }, true)).toBe("B G15");
  expect(laneName({ a: life(6) }, false)).toBe("G6");
});
