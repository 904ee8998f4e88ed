// The plan family as a plot: what each plan is worth, against the chance to carry it out.

import type { Moment, PlanOption } from "../model/types";
import { s } from "../ui/dom";
import { chance, energy, goalName, plain } from "../ui/format";

const WIDTH = 440;
const HEIGHT = 232;
const BOX = { left: 52, right: 14, top: 12, bottom: 34 };

export interface FamilyHandlers {
  /** A member picked out, or none. */
  point(option: number | undefined): void;
}

/** Round numbers within a range, about five of them. */
export const ticks = (min: number, max: number): number[] => {
  const span = max - min;
  if (!(span > 0)) return [min];
  const rough = span / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((one) => one * power >= rough) ?? 10) * power;
  const all: number[] = [];
  // Plus zero, because a negative zero would be written as such.
  for (let i = Math.ceil(min / step - 1e-9); i * step <= max + step * 1e-9; i++) all.push(i * step + 0);
  return all;
};

/** As many decimals as tell neighbouring ticks apart. */
const tickLabel = (value: number, all: readonly number[]): string => {
  const step = Math.abs((all[1] ?? value) - (all[0] ?? value)) || Math.abs(value) || 1;
  return value.toFixed(Math.min(6, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9))));
};

const padded = (values: readonly number[]): [number, number] => {
  const [min, max] = [Math.min(...values), Math.max(...values)];
  const span = max - min || Math.abs(max) * 0.05 || 1;
  return [min - span * 0.12, max + span * 0.12];
};

export const orderOf = (option: PlanOption): string => option.order.map(goalName).join(" › ") || "nothing";

export const familyPlot = (moment: Moment, picked: number | undefined, handlers: FamilyHandlers): SVGSVGElement => {
  const svg = s("svg", {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    class: "family",
    role: "img",
    "aria-label": `Plan family of decision ${moment.number}: ${moment.family.length} plans`,
  });
  if (moment.family.length === 0) return svg;
  const [x0, x1] = padded(moment.family.map((one) => one.value));
  const [y0, y1raw] = padded(moment.family.map((one) => one.reliability));
  const y1 = Math.min(y1raw, Math.max(1, ...moment.family.map((one) => one.reliability)) + 1e-4);
  const x = (value: number): number => BOX.left + ((value - x0) / (x1 - x0)) * (WIDTH - BOX.left - BOX.right);
  const y = (value: number): number => HEIGHT - BOX.bottom - ((value - y0) / (y1 - y0)) * (HEIGHT - BOX.top - BOX.bottom);
  const [low, high] = [Math.min(...moment.family.map((one) => one.energyJ)), Math.max(...moment.family.map((one) => one.energyJ))];
  const radius = (energyJ: number): number => 4 + (high > low ? (5 * (energyJ - low)) / (high - low) : 2);

  const [xs, ys] = [ticks(x0, x1), ticks(y0, y1)];
  for (const value of xs) {
    svg.append(
      s("line", { x1: x(value), x2: x(value), y1: BOX.top, y2: HEIGHT - BOX.bottom, class: "grid" }),
      s("text", { x: x(value), y: HEIGHT - BOX.bottom + 14, class: "tick", "text-anchor": "middle" }, tickLabel(value, xs)),
    );
  }
  for (const value of ys) {
    svg.append(
      s("line", { x1: BOX.left, x2: WIDTH - BOX.right, y1: y(value), y2: y(value), class: "grid" }),
      s("text", { x: BOX.left - 6, y: y(value) + 3.5, class: "tick", "text-anchor": "end" }, tickLabel(value, ys)),
    );
  }
  svg.append(
    s("text", { x: WIDTH - BOX.right, y: HEIGHT - 4, class: "axis", "text-anchor": "end" }, "value by the mission's policy"),
    s("text", { x: 12, y: BOX.top, class: "axis", "text-anchor": "end", transform: `rotate(-90 12 ${BOX.top})` }, "reliability"),
  );
  // The chosen plan last, so that it lies on top.
  const order = moment.family.map((_, index) => index).sort((a, b) => Number(a === moment.chosen) - Number(b === moment.chosen));
  for (const index of order) {
    const one = moment.family[index];
    if (!one) continue;
    const kind = `plan${index === moment.chosen ? " chosen" : ""}${index === picked ? " picked" : ""}`;
    const dot = s(
      "circle",
      { cx: x(one.value), cy: y(one.reliability), r: radius(one.energyJ), class: kind, "data-option": index },
      s("title", {}, `${orderOf(one)}\nvalue ${plain(one.value)}, reliability ${chance(one.reliability)}, ${energy(one.energyJ)}`),
    );
    dot.addEventListener("pointerenter", () => handlers.point(index));
    svg.append(dot);
  }
  svg.addEventListener("pointerleave", () => handlers.point(undefined));
  return svg;
};
