// The legend of the map: what the colours and lines mean.

import { colourTable, css } from "../view/colour";
import type { Scale } from "../view/paint";
import { h } from "./dom";

const WAYS = ["driven", "next leg", "plan"] as const;

export class Legend {
  readonly element = h("div", { class: "legend" });

  /** Why there is no map. */
  none(why: string): void {
    this.element.replaceChildren(h("p", {}, why));
  }

  /** `note` says how heights and light were drawn. */
  show(name: string, scale: Scale, note: string): void {
    const table = colourTable(scale.colours);
    const bar = h("div", { class: "bar" });
    bar.style.background = `linear-gradient(90deg, ${Array.from({ length: 24 }, (_, i) => css(table, i / 23)).join(", ")})`;
    const { min, max } = scale;
    const labels = [0, 0.25, 0.5, 0.75, 1].map((part) => h("span", {}, legendLabel(min + part * (max - min), max - min)));
    this.element.replaceChildren(h("p", {}, h("b", {}, name)), bar, h("div", { class: "ticks" }, labels), h("p", { class: "sub" }, note), wayKey());
  }
}

/** As many decimals as a step of the legend needs. */
const legendLabel = (value: number, span: number): string => value.toFixed(Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(span || 1)))));

/** What the lines on the map are. */
const wayKey = (): HTMLElement =>
  h(
    "p",
    { class: "ways sub" },
    WAYS.map((way) => h("span", {}, h("i", { class: way.replace(" ", "-") }), way)),
  );
