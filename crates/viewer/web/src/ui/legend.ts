// The legend of the map: what the colours, lines and marks mean.

import { stateLabel } from "../model/states";
import type { GoalState } from "../model/states";
import { classStep, colourTable, css, cssAt, NO_CLASS } from "../view/colour";
import { markIcon } from "../view/marks";
import type { Scale } from "../view/paint";
import type { Way } from "../view/shapes";
import { h } from "./dom";
import { plain } from "./format";

/** What a legend says, for the page and for a saved figure alike. */
export interface LegendWords {
  title: string;
  scale: Scale;
  /** Names of the classes, in the order of the scale's. */
  classes: readonly string[];
  /** Whether there are values of no class. */
  odd: boolean;
  /** How heights and light were drawn, and what is missing. */
  notes: readonly string[];
  /** What must be known not to be misled; said wherever there is a legend. */
  cautions: readonly string[];
  ways: readonly Way["what"][];
  /** States that goals on the map are in. */
  marks: readonly GoalState[];
}

export const WAY_COLOURS: Record<Way["what"], string> = {
  driven: "#0072b2",
  "next leg": "#d55e00",
  plan: "#e69f00",
  alternative: "#cc79a7",
  "picked alternative": "#cc79a7",
  "pose to goal": "#1a1c1f",
};

const TICKS = [0, 0.25, 0.5, 0.75, 1] as const;

export class Legend {
  readonly element = h("div", { class: "legend" });

  /** Why there is no map. */
  none(why: string): void {
    this.element.replaceChildren(h("p", {}, why));
  }

  show(words: LegendWords): void {
    this.element.replaceChildren(
      h("p", {}, h("b", {}, words.title)),
      ...(words.scale.classes ? [classList(words)] : ramp(words.scale)),
      ...words.notes.map((note) => h("p", { class: "sub" }, note)),
      ...words.cautions.map((caution) => h("p", { class: "caution" }, caution)),
      h("p", { class: "ways sub" }, words.ways.map(wayKey), words.marks.map((state) => h("span", {}, markIcon(state), stateLabel[state]))),
    );
  }
}

const ramp = (scale: Scale): HTMLElement[] => {
  const table = colourTable(scale.colours);
  const bar = h("div", { class: "bar" });
  bar.style.background = `linear-gradient(90deg, ${Array.from({ length: 24 }, (_, i) => css(table, i / 23)).join(", ")})`;
  return [bar, h("div", { class: "ticks" }, tickLabels(scale).map((label) => h("span", {}, label)))];
};

/** Values under the ramp, from its left end to its right. */
export const tickLabels = ({ min, max, beyond }: Scale): string[] => {
  const labels = TICKS.map((part) => written(min + part * (max - min), max - min));
  return labels.map((label, i) => (i === 0 && beyond && beyond.min < min ? `≤ ${label}` : i === labels.length - 1 && beyond && beyond.max > max ? `≥ ${label}` : label));
};

/** How far values go that have the colour of an end. */
export const beyondNote = ({ beyond }: Scale): string[] => (beyond ? [`beyond the ends: values from ${plain(beyond.min)} to ${plain(beyond.max)}`] : []);

/** The colour of each class. */
export const classColours = (words: LegendWords): { name: string; colour: string }[] => {
  const table = colourTable(words.scale.colours);
  const all = words.classes.map((name, i) => ({ name, colour: cssAt(table, classStep(i)) }));
  return words.odd ? [...all, { name: "no class", colour: cssAt(table, NO_CLASS) }] : all;
};

/** The number stands beside the colour: neither is the only sign. */
const classList = (words: LegendWords): HTMLElement =>
  h(
    "ul",
    { class: "classes" },
    classColours(words).map(({ name, colour }) => {
      const swatch = h("i");
      swatch.style.background = colour;
      return h("li", {}, swatch, name);
    }),
  );

const wayKey = (what: Way["what"]): HTMLElement => {
  const stroke = h("i", { class: what === "pose to goal" ? "thin" : "" });
  stroke.style.background = WAY_COLOURS[what];
  return h("span", {}, stroke, what);
};

/** As many decimals as a step of the legend needs. */
const written = (value: number, span: number): string => {
  const text = value.toFixed(Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(span || 1)))));
  return /^-0\.?0*$/.test(text) ? text.slice(1) : text;
};
