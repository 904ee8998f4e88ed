// The plan family as a plot: interest against the chance to carry it out, or any two of a plan's numbers; the size of
// a mark is energy.

import { bestFound } from "../model/choice";
import type { Moment, PlanOption } from "../model/types";
import { s } from "../ui/dom";
import { chance, clock, energy, goalName, metres, plain } from "../ui/format";

const WIDTH = 440;
const HEIGHT = 232;
const BOX = { left: 52, right: 14, top: 12, bottom: 34 };

export type Measure = "prize" | "value" | "expected" | "reliability" | "energyJ" | "timeS" | "lengthM";

interface Kind {
  label: string;
  /** What an axis shows: joules as megajoules, seconds as hours. */
  per: number;
  told(value: number): string;
}

export const MEASURES: Record<Measure, Kind> = {
  prize: { label: "interest (sum of prizes)", per: 1, told: plain },
  value: { label: "value by the mission's policy", per: 1, told: plain },
  expected: { label: "expected interest", per: 1, told: plain },
  reliability: { label: "reliability", per: 1, told: chance },
  energyJ: { label: "energy, MJ", per: 1e6, told: energy },
  timeS: { label: "time, h", per: 3600, told: clock },
  lengthM: { label: "way, m", per: 1, told: metres },
};

export interface FamilyHandlers {
  /** A member picked out, or none. */
  point(option: number | undefined): void;
}

/** Round numbers within a range, about five of them. */
export const ticks = (min: number, max: number): number[] => {
  const span = max - min;
  if (!(span > 0) || !Number.isFinite(span)) return [min];
  const rough = span / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((one) => one * power >= rough) ?? 10) * power;
  const all: number[] = [];
  // Plus zero, because a negative zero would be written as such.
  for (let i = Math.ceil(min / step - 1e-9); i * step <= max + step * 1e-9; i++) all.push(i * step + 0);
  return all;
};

/** As many decimals as tell neighbouring ticks apart. */
export const tickLabel = (value: number, all: readonly number[]): string => {
  const step = Math.abs((all[1] ?? value) - (all[0] ?? value)) || Math.abs(value) || 1;
  return value.toFixed(Math.min(6, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9))));
};

const padded = (values: readonly number[]): [number, number] => {
  const [min, max] = [Math.min(...values), Math.max(...values)];
  const span = max - min || Math.abs(max) * 0.05 || 1;
  return [min - span * 0.12, max + span * 0.12];
};

export const orderOf = (option: PlanOption): string => option.order.map(goalName).join(" › ") || "nothing";

/** The best found, where another was kept. */
const SQUARE = (r: number): string => `M${-r} ${-r}H${r}V${r}H${-r}Z`;
const CIRCLE = (r: number): string => `M${-r} 0A${r} ${r} 0 1 1 ${r} 0A${r} ${r} 0 1 1 ${-r} 0Z`;
/** The chosen plan has corners: colour is never the only sign. */
const DIAMOND = (r: number): string => `M0 ${-r * 1.35}L${r * 1.35} 0L0 ${r * 1.35}L${-r * 1.35} 0Z`;

export const familyPlot = (moment: Moment, across: Measure, up: Measure, picked: number | undefined, handlers: FamilyHandlers): SVGSVGElement => {
  const svg = s("svg", {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    class: "family",
    role: "img",
    "aria-label": `Plan family of decision ${moment.number}: ${moment.family.length} plans, ${MEASURES[across].label} and ${MEASURES[up].label}`,
  });
  if (moment.family.length === 0) return svg;
  const numbers = (of: Measure): number[] => moment.family.map((one) => one[of] / MEASURES[of].per);
  const [x0, x1] = padded(numbers(across));
  const [y0, y1raw] = padded(numbers(up));
  // No chance is above one.
  const y1 = up === "reliability" ? Math.min(y1raw, Math.max(1, ...numbers(up)) + 1e-4) : y1raw;
  const x = (value: number): number => BOX.left + ((value - x0) / (x1 - x0)) * (WIDTH - BOX.left - BOX.right);
  const y = (value: number): number => HEIGHT - BOX.bottom - ((value - y0) / (y1 - y0)) * (HEIGHT - BOX.top - BOX.bottom);
  axes(svg, { across, up, xs: ticks(x0, x1), ys: ticks(y0, y1), x, y });

  const [low, high] = [Math.min(...numbers("energyJ")), Math.max(...numbers("energyJ"))];
  const radius = (one: PlanOption): number => 4 + (high > low ? (5 * (one.energyJ / 1e6 - low)) / (high - low) : 2);
  const best = bestFound(moment);
  const rank = (index: number): number => (index === moment.chosen ? 2 : index === best ? 1 : 0);
  // The chosen plan last, so that it lies on top.
  const order = moment.family.map((_, index) => index).sort((a, b) => rank(a) - rank(b));
  for (const index of order) {
    const one = moment.family[index];
    if (!one) continue;
    const isChosen = index === moment.chosen;
    const r = Math.round(radius(one) * 100) / 100;
    const mark = s(
      "path",
      {
        d: isChosen ? DIAMOND(r) : index === best ? SQUARE(r) : CIRCLE(r),
        transform: `translate(${x(one[across] / MEASURES[across].per).toFixed(2)} ${y(one[up] / MEASURES[up].per).toFixed(2)})`,
        class: `plan${isChosen ? " chosen" : index === best ? " best" : ""}${index === picked ? " picked" : ""}`,
        "data-option": index,
      },
      s("title", {}, `${isChosen ? "chosen: " : index === best ? "best found: " : ""}${orderOf(one)}\ninterest ${plain(one.prize)}, value ${plain(one.value)}, reliability ${chance(one.reliability)}, ${energy(one.energyJ)}, ${clock(one.timeS)}`),
    );
    mark.addEventListener("pointerenter", () => handlers.point(index));
    svg.append(mark);
  }
  svg.addEventListener("pointerleave", () => handlers.point(undefined));
  return svg;
};

interface Axes {
  across: Measure;
  up: Measure;
  xs: readonly number[];
  ys: readonly number[];
  x(value: number): number;
  y(value: number): number;
}

const axes = (svg: SVGSVGElement, { across, up, xs, ys, x, y }: Axes): void => {
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
    s("text", { x: WIDTH - BOX.right, y: HEIGHT - 4, class: "axis", "text-anchor": "end" }, MEASURES[across].label),
    s("text", { x: 11, y: BOX.top, class: "axis", "text-anchor": "end", transform: `rotate(-90 11 ${BOX.top})` }, MEASURES[up].label),
  );
};

const STYLE =
  "text{font-family:system-ui,sans-serif}.grid{stroke:#ddd}.tick,.axis{font-size:11px;fill:#444}.plan{fill:#56b4e9;fill-opacity:.55;stroke:#1f5f86}.plan.best{fill:#009e73;fill-opacity:1;stroke:#111}.plan.chosen{fill:#d55e00;fill-opacity:1;stroke:#111}";

/** The plot with its colours inside, to stand without this page. */
export const familyFigure = (moment: Moment, across: Measure, up: Measure): SVGSVGElement => {
  const svg = familyPlot(moment, across, up, undefined, { point: () => undefined });
  svg.setAttribute("width", String(WIDTH));
  svg.setAttribute("height", String(HEIGHT));
  svg.prepend(s("style", {}, STYLE), s("rect", { width: WIDTH, height: HEIGHT, fill: "#fff" }));
  return svg;
};
