// The pane of the map: what is chosen on the left, the map, and what moves it on the right.

import type { Store, View } from "../state";
import { h } from "../ui/dom";
import type { Ground } from "./ground";
import type { Layers } from "./layers";
import { Modes } from "./modes";
import type { Readout } from "./readout";
import { apart } from "./side";
import type { Sides } from "./side";

const HEIGHTS: readonly (number | undefined)[] = [undefined, 0.5, 1, 2, 3, 5, 10];

/** Where map and decision stand side by side. */
const WIDE = "(width >= 1000px)";

/** Width of the column on the left. */
const COLUMN_PX = 290;

export class MapPane {
  readonly element: HTMLElement;
  private readonly relief: HTMLButtonElement;
  private readonly alternatives: HTMLButtonElement;
  private readonly solid: HTMLButtonElement;
  readonly modes: Modes;
  /** Where values of a cell go that have no room beside the map. */
  dock: HTMLElement | undefined;
  private readonly column: HTMLElement;
  /** Whether they were too many for the column. */
  private crowded = false;
  private readonly heights = h("select", { "aria-label": "Heights stretched by", title: "Heights stretched by (h)", hidden: true }, HEIGHTS.map((by) => h("option", { value: by ?? "" }, by === undefined ? "heights: auto" : `heights × ${by}`)));
  /** The line between two runs in three dimensions; the flat map draws its own. */
  private readonly divide = h("div", { class: "divide", hidden: true }, h("b", {}, "A"), h("b", {}, "B"));
  private apart = false;

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
    private readonly ground: Ground,
    layers: Layers,
    private readonly readout: Readout,
  ) {
    const button = (label: string, title: string, onclick: () => void): HTMLButtonElement => h("button", { type: "button", title, "aria-pressed": "false", onclick }, label);
    const { view } = store;
    this.relief = button("relief", "Relief (s)", () => store.set({ shaded: !view.shaded }));
    this.alternatives = button("alternatives", "Ways of all alternatives in the plan family (w)", () => store.set({ alternatives: !view.alternatives }));
    this.solid = button("3-D", "Ground in three dimensions (v)", () => store.set({ solid: !view.solid }));
    this.modes = new Modes(store);
    this.heights.addEventListener("change", () => store.set({ heights: this.heights.value === "" ? undefined : Number(this.heights.value) }));
    const round = (label: string, title: string, name: string, onclick: () => void): HTMLElement => h("button", { type: "button", title, "aria-label": name, onclick }, label);
    this.column = h(
      "div",
      { class: "map-left" },
      h("div", { class: "map-tools" }, layers.element, layers.aspects, layers.colours, this.relief, this.alternatives, this.solid, this.heights, this.modes.element),
      layers.note,
      readout.element,
    );
    this.element = h(
      "section",
      { class: "map-pane", "aria-label": "Map" },
      ground.mapCanvas,
      ground.solidCanvas,
      this.divide,
      this.column,
      h(
        "div",
        { class: "zoom-tools" },
        round("+", "Zoom in (+)", "Zoom in", () => ground.zoom(1.25)),
        round("−", "Zoom out (−)", "Zoom out", () => ground.zoom(0.8)),
        round("⤢", "Whole map (0)", "Whole map", () => ground.fit()),
      ),
      ground.legend.element,
    );
    this.listenDivide();
    new ResizeObserver(() => this.crowd()).observe(readout.element);
    // With another size, or another run, there may be room again.
    new ResizeObserver(() => (this.crowded = false)).observe(this.element);
  }

  show(view: View): void {
    const two = this.sides.b?.run !== undefined;
    const pressed: [HTMLElement, boolean][] = [[this.relief, view.shaded], [this.alternatives, view.alternatives], [this.solid, view.solid]];
    for (const [button, on] of pressed) button.setAttribute("aria-pressed", String(on));
    this.apart = apart(this.sides);
    const halves = this.apart || view.split === "halves";
    this.modes.show(two, this.apart);
    this.element.dataset.split = !two ? "none" : halves ? "halves" : "wipe";
    this.settle(two);
    this.element.toggleAttribute("data-solid", this.ground.solid);
    this.heights.hidden = !this.ground.solid;
    this.heights.value = String(view.heights ?? "");
    // Of a difference there is but one ground.
    this.divide.hidden = !two || !this.ground.solid || (view.aspect === "between" && !this.apart);
    this.divide.style.left = `${100 * (halves ? 0.5 : view.wipe)}%`;
    this.divide.lastElementChild?.replaceChildren(this.apart ? "B, other ground" : "B");
  }

  /** Values of a cell stand beside the map; with two runs, or where they are too many, below the decision, which hides nothing of the map. */
  private settle(two: boolean): void {
    const { dock, readout } = this;
    const docked = dock !== undefined && (two || this.crowded) && matchMedia(WIDE).matches;
    const place = docked ? dock : this.column;
    if (readout.element.parentElement !== place) place.append(readout.element);
    readout.element.classList.toggle("docked", docked);
    this.element.dataset.readout = docked ? "docked" : this.inTheWay() ? "right" : "left";
  }

  /** Whether the values reach down to the legend. */
  private crowd(): void {
    const { element } = this.readout;
    if (this.crowded || element.parentElement !== this.column || element.childElementCount === 0) return;
    this.crowded = element.getBoundingClientRect().bottom > this.ground.legend.element.getBoundingClientRect().top;
    if (this.crowded) this.settle(this.sides.b?.run !== undefined);
  }

  /** Whether values on the left would hide what they are of. */
  private inTheWay(): boolean {
    return (this.ground.probeX ?? Number.POSITIVE_INFINITY) < COLUMN_PX;
  }

  nextHeights(): void {
    const { heights } = this.store.view;
    this.store.set({ heights: HEIGHTS[(HEIGHTS.indexOf(heights) + 1) % HEIGHTS.length] });
  }

  /** Says that the ground cannot stand up here. */
  noSolid(): void {
    this.solid.disabled = true;
    this.solid.title = "This browser has no WebGL";
  }

  private listenDivide(): void {
    const { divide } = this;
    divide.addEventListener("pointerdown", (event) => divide.setPointerCapture(event.pointerId));
    divide.addEventListener("pointermove", (event) => {
      if (this.apart || !divide.hasPointerCapture(event.pointerId)) return;
      const { left, width } = this.element.getBoundingClientRect();
      this.store.set({ split: "wipe", wipe: Math.min(1, Math.max(0, (event.clientX - left) / width)) });
    });
  }
}
