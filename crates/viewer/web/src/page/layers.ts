// The choice of what the map shows.

import type { Aspect, Store, View } from "../state";
import { PUT_IN } from "../ui/notices";
import { h } from "../ui/dom";
import { choices, GROUPS, title } from "./choices";
import type { Choice } from "./choices";
import { apart } from "./side";
import type { Sides } from "./side";

const COLOURS: readonly View["colours"][] = ["viridis", "cividis", "batlow"];

const ASPECTS: readonly [Aspect, string][] = [
  ["value", "as it is"],
  ["change", "change since last"],
  ["between", "A less B"],
];

/** Where derived layers can be had, for a page that has none. */
const WHERE = `derived layers: wisdom view LOG; whoever sends this page puts them in by ${PUT_IN}`;

export class Layers {
  readonly element = h("select", { class: "layer", "aria-label": "Layer", title: "Layer (l)" });
  readonly aspects = h("select", { "aria-label": "Shown of the layer", title: "As it is, its change, or A less B (a)" });
  readonly colours = h("select", { "aria-label": "Colours", title: "Colours" }, COLOURS.map((name) => h("option", { value: name }, name)));
  /** Why there are no derived layers. */
  readonly note = h("p", { class: "derived-note sub", hidden: true });
  private all: Choice[] = [];
  private offered = "";

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
  ) {
    this.element.addEventListener("change", () => store.set({ layer: this.element.value }));
    this.aspects.addEventListener("change", () => store.set({ aspect: this.aspects.value as Aspect }));
    this.colours.addEventListener("change", () => store.set({ colours: this.colours.value as View["colours"] }));
  }

  /** The layer that is looked at. */
  get choice(): Choice | undefined {
    return this.all.find(({ id }) => id === this.store.view.layer);
  }

  /** All layers there are, in the order that they are offered in. */
  get choices(): readonly Choice[] {
    return this.all;
  }

  /** Offers what the open logs hold, and what is derived from them. */
  offer(): void {
    const { a, b } = this.sides;
    // What is derived may be known before the first map was read; that one comes first all the same.
    if (!a?.run || (a.run.planes.length === 0 && a.run.wholeness.kind === "reading")) return;
    const all = choices(a.run.planes, a.derivable);
    const both = b !== undefined && !apart(this.sides);
    const offered = JSON.stringify([all, both, a.derivable]);
    if (offered === this.offered) return;
    this.offered = offered;
    this.all = all;
    const { view } = this.store;
    if (!this.choice) this.store.set({ layer: all[0]?.id ?? "" });
    if (!both && view.aspect === "between") this.store.set({ aspect: "value" });
    const groups = GROUPS.map((group) => ({ group, of: all.filter((one) => one.group === group) })).filter(({ of }) => of.length > 0);
    this.element.replaceChildren(...groups.map(({ group, of }) => h("optgroup", { label: group }, of.map((one) => h("option", { value: one.id }, title(one))))));
    this.aspects.replaceChildren(...ASPECTS.filter(([aspect]) => both || aspect !== "between").map(([aspect, label]) => h("option", { value: aspect }, label)));
    const why = a.derivable && "unavailable" in a.derivable ? a.derivable.unavailable : undefined;
    this.note.hidden = why === undefined;
    this.note.textContent = why ? `no derived layers: ${why}` : WHERE;
    this.show();
  }

  /** Shows what was chosen by other means. */
  show(): void {
    const { view } = this.store;
    this.element.value = view.layer;
    this.aspects.value = view.aspect;
    this.colours.value = view.colours;
  }

  next(by: number): void {
    const at = this.all.findIndex(({ id }) => id === this.store.view.layer);
    const next = this.all[(at + by + this.all.length) % this.all.length];
    if (next) this.store.set({ layer: next.id });
  }

  nextAspect(): void {
    const all = [...this.aspects.options].map(({ value }) => value as Aspect);
    this.store.set({ aspect: all[(all.indexOf(this.store.view.aspect) + 1) % all.length] ?? "value" });
  }
}
