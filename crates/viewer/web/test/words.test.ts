// What the page says of codes, of numbers beside each other, and of a plan that was kept.

import { readFileSync } from "node:fs";

import { describe, expect, test } from "vitest";

import { bestFound, heldPlans, otherwiseBegun, variants } from "../src/model/choice";
import { hysteresis, weights } from "../src/model/mission";
import type { Moment, PlanOption, Verdict } from "../src/model/types";
import { heldWords } from "../src/ui/choice";
import { apart, excess } from "../src/ui/compared";
import { clock, plain, reason, term, termOf, trigger } from "../src/ui/format";
import { withItLine } from "../src/ui/prices";
import { ACTIONS, REASONS, TRANSFORMATIONS, saying } from "../src/ui/sayings";

const plan = (order: number[], value: number): PlanOption => ({ order, poses: [], value, prize: value, expected: value, reliability: 0.9, timeS: 1, energyJ: 1, dataMb: 0, lengthM: 1, frontBest: 0, frontPlans: 1, objectives: [] });
const moment = (family: PlanOption[], chosen: number, held: boolean): Moment => ({ ...({} as Moment), family, chosen, held, verdicts: [], legs: [] });

test("every code that the manual names has a sentence of its own", () => {
  const manual = readFileSync(new URL("../../../../docs/goals.md", import.meta.url), "utf8");
  const part = manual.split("## What becomes of them")[1]?.split("## Their life")[0] ?? "";
  const rows = [...part.matchAll(/^\| ([a-z, ]+) \|[^|]*\|([^|]*)\|$/gm)].filter(([, name]) => name !== "transformation");
  expect(rows.length).toBeGreaterThan(9);
  for (const [, names] of rows) for (const name of (names ?? "").split(", ")) expect(TRANSFORMATIONS[name], name).toBeTruthy();
  const after = part.split("| reorder |")[1] ?? "";
  const told = [...rows.map(([, , codes]) => codes ?? ""), after].join(" ");
  const codes = [...told.matchAll(/`([a-z-]+)`/g)].map(([, code]) => code ?? "");
  expect(codes.length).toBeGreaterThan(35);
  for (const code of codes) expect(REASONS[code], code).toBeTruthy();
  for (const action of "add keep modify reorder defer drop achieve".split(" ")) expect(ACTIONS[action], action).toBeTruthy();
  expect(new Set(Object.values(REASONS)).size).toBe(Object.keys(REASONS).length);
});

describe("numbers beside each other", () => {
  test("are written in as many digits as tell them apart", () => {
    expect(apart(8.5271, 8.533, plain)).toEqual(["8.527", "8.533"]);
    expect(apart(0.5, 0.5, plain)).toEqual(["0.5000", "0.5000"]);
    expect(apart(1 / 3, 1 / 3 + 1e-9, plain)[0]).not.toBe(apart(1 / 3, 1 / 3 + 1e-9, plain)[1]);
    expect(excess(8.5271, 8.533, plain)).toBe("−0.0059");
    expect(excess(3620, 3600, clock)).toBe("+20 s");
    expect(term({ name: "prize", value: 0.2859, limit: 0.2764 })).toBe("prize 0.2859 against 0.2764 (+0.0095)");
    expect(term({ name: "poses", value: 0, limit: 1 })).toBe("poses 0 against 1");
  });

  test("are named as the log means them: prizes with a directive's weight in them, and prizes without", () => {
    const due = { name: "interest-changed", goal: 10, numbers: [{ name: "before", value: 0.291 }, { name: "after", value: 0.141 }] };
    expect(trigger(due)).toBe("interest-changed G10 prize 0.291 → 0.141 (−0.150)");
    expect(trigger({ ...due, name: "conflict" })).toBe("conflict G10 contradiction 0.291 → 0.141 (−0.150)");
    expect(termOf("peak-moved", { name: "prize at the old target", value: 0.4685, limit: 0.9604 })).toMatch(/^unweighted prize at the old target 0.4685 against 0.9604/);
    expect(termOf("merged", { name: "prize", value: 0.4, limit: 0.5 })).toMatch(/^unweighted prize/);
    expect(termOf("excluded", { name: "prize", value: 0.4, limit: 0.5 })).toMatch(/^prize/);
  });

  test("are those of the mission's file, as changed for the run", () => {
    const mission = '[goals]\nmin-prominence = 0.1\n[[directive]]\nname = "a"\nweight = 0.3 # less\n[[directive]]\nname = "b"\n[triggers]\nweight = 9\n';
    expect([...weights(mission, "")]).toEqual([["a", 0.3], ["b", 1]]);
    expect([...weights(mission, "seed=3\ndirective.1.weight=2")]).toEqual([["a", 0.3], ["b", 2]]);
    expect(hysteresis(mission, "")).toBe(0.05);
    expect(hysteresis(mission.replace("min-prominence", "hysteresis"), "")).toBe(0.1);
    expect(hysteresis(mission, "goals.hysteresis=0")).toBe(0);
    expect(hysteresis("", "")).toBeUndefined();
  });
});

describe("a committed plan that was kept", () => {
  const family = [plan([1, 2], 8.574), plan([1, 3], 8.539), plan([1, 2], 8.5), plan([3, 1], 8.4), plan([1, 3], 8.3)];

  test("stands beside the best found, with what a change must gain", () => {
    const kept = moment(family, 1, true);
    expect([bestFound(kept), heldPlans(kept)?.kept.value]).toEqual([0, 8.539]);
    expect(heldWords(kept, 0.05)).toBe("best found 8.574, kept 8.539 (−0.0350); a change must gain at least 0.4269, 5 % of what is kept");
    expect(heldWords(kept, undefined)).not.toContain("%");
    expect(heldWords(moment(family, 0, false), 0.05)).toBeUndefined();
  });

  test("and the best found are never folded with plans of their order", () => {
    expect(variants(moment(family, 1, true))).toEqual([{ shown: [0], folded: [2] }, { shown: [1], folded: [4] }, { shown: [3], folded: [] }]);
    expect(variants(moment(family, 2, true))[0]).toEqual({ shown: [0, 2], folded: [] });
    expect(variants(moment(family, 4, false))[1]).toEqual({ shown: [4], folded: [1] });
  });

  test("is held against the best plan that begins with another goal", () => {
    expect(otherwiseBegun(moment(family, 1, true))?.order).toEqual([3, 1]);
    expect(otherwiseBegun(moment(family.slice(0, 2), 0, false))).toBeUndefined();
  });
});

test("a goal excluded by one of a smaller prize is told by whom, and why that may be", () => {
  const goal = { ...({} as Verdict["goal"]), id: 29 };
  const verdict: Verdict = { goal, action: "defer", reason: "excluded", cause: "discovery", other: 10, terms: [{ name: "prize", value: 0.2859, limit: 0.2764 }], transformation: "identity", changes: [], steps: [] };
  expect(reason(verdict)).toBe("excluded G10: prize 0.2859 against 0.2764 (+0.0095)");
  expect(saying(verdict, moment([], 0, true))).toMatch(/G29 lies so near G10.*G10 is the smaller.*held/);
  expect(saying(verdict, moment([], 0, false))).toMatch(/weighed whole/);
  expect(saying({ ...verdict, terms: [{ name: "prize", value: 0.2, limit: 0.3 }] }, moment([], 0, true))).not.toMatch(/smaller/);
});

test("the plan with a goal that was left out says what it displaces, and by what lever", () => {
  const nothing = { kind: "unknown" } as const;
  const tag = { goal: "G12", interestWas: 0.8, energyJ: nothing, timeS: nothing, reliability: nothing, prize: nothing, interest: undefined, withIt: { order: ["G8", "G12"], displaced: ["G10"], value: 8.5271, reliability: 0.95, timeS: 3600, energyJ: 1.2e6, lever: "energy" } };
  expect(withItLine(tag, { reason: "data", value: 8.533, reliability: 0.96 })).toBe("G8 › G12: value 8.527 (−0.0059), reliability 0.9500 (−0.0100), 1:00 h, 1.20 MJ; displaces G10 (with the energy it asks for)");
  expect(withItLine({ ...tag, withIt: undefined }, undefined)).toBeUndefined();
});
