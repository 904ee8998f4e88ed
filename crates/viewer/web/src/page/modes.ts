// How two runs are shown: with a wipe between them, side by side, or as their difference.

import type { Store, View } from "../state";
import { h } from "../ui/dom";

type Mode = "side by side" | "wipe" | "A less B";

type Change = Pick<View, "split" | "aspect">;

/** What of a layer is shown stays, unless it was the difference. */
const plain = (view: Change): View["aspect"] => (view.aspect === "between" ? "value" : view.aspect);

const MODES: readonly { mode: Mode; title: string; set(view: Change): Change }[] = [
  { mode: "wipe", title: "One map, A left of the line and B right of it (b)", set: (view) => ({ split: "wipe", aspect: plain(view) }) },
  { mode: "side by side", title: "Two maps under one hand (b)", set: (view) => ({ split: "halves", aspect: plain(view) }) },
  { mode: "A less B", title: "What A has more of, and what B (b)", set: () => ({ split: "wipe", aspect: "between" }) },
];

export const modeOf = ({ split, aspect }: Pick<View, "split" | "aspect">): Mode => (aspect === "between" ? "A less B" : split === "halves" ? "side by side" : "wipe");

export class Modes {
  readonly element = h("div", { class: "modes", role: "group", "aria-label": "How the two runs are shown", hidden: true });
  private readonly buttons: HTMLButtonElement[];
  private apart = false;

  constructor(private readonly store: Store) {
    this.buttons = MODES.map(({ mode, title, set }) => h("button", { type: "button", title, onclick: () => store.set(set(store.view)) }, mode));
    this.element.append(...this.buttons);
  }

  /** The next of the three. */
  next(): void {
    if (this.apart) return;
    const at = MODES.findIndex(({ mode }) => mode === modeOf(this.store.view));
    const next = MODES[(at + 1) % MODES.length];
    if (next) this.store.set(next.set(this.store.view));
  }

  /** Runs on different ground stand side by side and no other way: a cell of one is none of the other. */
  show(two: boolean, apart: boolean): void {
    this.element.hidden = !two;
    this.apart = apart;
    const now = apart ? "side by side" : modeOf(this.store.view);
    this.buttons.forEach((button, i) => {
      const one = MODES[i];
      button.setAttribute("aria-pressed", String(one?.mode === now));
      button.disabled = apart && one?.mode !== now;
      button.title = button.disabled ? "The runs stand on different ground" : (one?.title ?? "");
    });
  }
}
