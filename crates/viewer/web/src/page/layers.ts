// The choice of what the map shows, and the scale that each layer is shown by.

import { range } from "../model/plane";
import type { Plane } from "../model/plane";
import type { PlaneName } from "../model/types";
import { BETWEEN, DIFFERENCE } from "../planes";
import type { Store, View } from "../state";
import { h } from "../ui/dom";
import type { Scale } from "../view/paint";
import type { Sides } from "./side";

const COLOURS: readonly View["colours"][] = ["viridis", "cividis", "batlow"];

export class Layers {
  readonly element = h("select", { "aria-label": "Layer", title: "Layer (l)" });
  readonly colours = h("select", { "aria-label": "Colours" }, COLOURS.map((name) => h("option", { value: name }, name)));
  private offered = "";

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
  ) {
    this.element.addEventListener("change", () => store.set({ layer: this.element.value }));
    this.colours.addEventListener("change", () => store.set({ colours: this.colours.value as View["colours"] }));
  }

  /** Offers what the open logs hold. */
  offer(): void {
    const planes = this.sides.a?.run?.planes ?? [];
    const all = planes.some(({ id }) => id === "map:interest")
      ? [...planes.slice(0, 1), { id: DIFFERENCE, label: "interest, change since last" }, ...(this.sides.b ? [{ id: BETWEEN, label: "interest, A less B" }] : []), ...planes.slice(1)]
      : planes;
    const offered = JSON.stringify(all);
    if (offered === this.offered) return;
    this.offered = offered;
    if (!all.some(({ id }) => id === this.store.view.layer)) this.store.set({ layer: all[0]?.id ?? "" });
    this.element.replaceChildren(...all.map(({ id, label }) => h("option", { value: id, ...(id === this.store.view.layer ? { selected: true } : {}) }, label)));
  }

  next(by: number): void {
    const all = [...this.element.options].map((option) => option.value);
    const next = all[(all.indexOf(this.store.view.layer) + by + all.length) % all.length];
    if (next) this.store.set({ layer: next });
  }
}

/** What a layer is called in its legend. */
export const layerName = (layer: string, planes: readonly PlaneName[]): string => {
  if (layer === DIFFERENCE) return "change of interest";
  if (layer === BETWEEN) return "interest of A less that of B";
  return planes.find(({ id }) => id === layer)?.label ?? layer;
};

/** What colours a layer is shown in, and from where to where. */
export const scaleOf = (layer: string, plane: Plane | undefined, colours: View["colours"]): Scale => {
  if (layer === "map:interest" || layer.startsWith("doubt:")) return { colours: layer.startsWith("doubt:") ? "cividis" : colours, min: 0, max: 1 };
  const found = (plane && range(plane)) ?? { min: 0, max: 1 };
  if (layer === DIFFERENCE || layer === BETWEEN) {
    const most = Math.max(0.05, Math.abs(found.min), Math.abs(found.max));
    return { colours: "diverging", min: -most, max: most };
  }
  return { colours: layer.endsWith(":elevation") ? "stone" : colours, ...found };
};
