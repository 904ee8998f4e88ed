// The head of the page: what run this is, how whole its file is, and what can be done with it.

import type { Run } from "../model/run";
import { h } from "./dom";
import { bytes } from "./format";

export interface HeaderHandlers {
  png(): void;
  svg(): void;
  csv(): void;
  open(): void;
  compare(): void;
  theme(): void;
  help(): void;
}

export class Header {
  readonly element: HTMLElement;
  readonly facts = h("div", { class: "facts-line" });
  /** What can be saved. */
  private readonly menu = h("details", { class: "menu" }, h("summary", { title: "Save the map or the goals" }, "Save"));

  constructor(handlers: HeaderHandlers) {
    const saved = (label: string, title: string, save: () => void): HTMLElement =>
      h(
        "button",
        {
          type: "button",
          title,
          onclick: () => {
            this.menu.open = false;
            save();
          },
        },
        label,
      );
    this.menu.append(
      h(
        "div",
        {},
        saved("Map as PNG", "The map as a picture", handlers.png),
        saved("Map as SVG", "The flat map with its marks, legend and scale as lines and words", handlers.svg),
        saved("Goals as CSV", "Goals of this decision as a table", handlers.csv),
      ),
    );
    this.closeMenu();
    this.element = h(
      "header",
      {},
      h("h1", {}, "Wisdom"),
      this.facts,
      h(
        "div",
        { class: "actions" },
        this.menu,
        h("button", { type: "button", title: "Open a log (o)", onclick: handlers.open }, "Open…"),
        h("button", { type: "button", title: "Open a second log beside this one (c), or drop it with Shift", onclick: handlers.compare }, "Compare…"),
        h("button", { type: "button", title: "Light or dark (d)", "aria-label": "Light or dark", onclick: handlers.theme }, "◐"),
        h("button", { type: "button", title: "Keys (?)", "aria-label": "Keys", onclick: handlers.help }, "?"),
      ),
    );
  }

  show(run: Run, other: Run | undefined): void {
    const { run: facts, name, bytes: size } = run.facts;
    const whole = run.wholeness.kind;
    const parts = [
      h("b", { class: "mission" }, facts.mission ?? name),
      h("span", { class: `pill ${whole}` }, state(run)),
      // The files before what they say: of two runs it must be seen which they are.
      fact("file", `${name}, ${bytes(size)}`),
      fact("B", other?.facts.name),
      fact("rule", facts.rule),
      fact("policy", facts.policy),
      fact("prize", facts.prize),
      fact("seed", facts.seed),
      fact("wisdom", facts.version),
      // Last, because it may be long.
      fact("overrides", facts.overrides?.replaceAll("\n", ", ")),
    ];
    this.facts.replaceChildren(...parts.filter((part) => part !== undefined));
    document.title = `${facts.mission ?? name}: Wisdom replay`;
  }

  /** A menu is left by Escape, and by turning to anything else. */
  private closeMenu(): void {
    const { menu } = this;
    menu.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || !menu.open) return;
      menu.open = false;
      menu.querySelector("summary")?.focus();
      event.stopPropagation();
    });
    document.addEventListener("pointerdown", (event) => {
      if (event.target instanceof Node && !menu.contains(event.target)) menu.open = false;
    });
    menu.addEventListener("focusout", (event) => {
      if (event.relatedTarget instanceof Node && !menu.contains(event.relatedTarget)) menu.open = false;
    });
  }

  /** How far reading is: a banner that comes and goes would push the map about. */
  progress(run: Run): void {
    const pill = this.facts.querySelector(".pill");
    if (pill) pill.textContent = `reading, ${Math.round((100 * run.readBytes) / Math.max(1, run.facts.bytes))} %`;
  }
}

const fact = (label: string, value: string | undefined): HTMLElement | undefined =>
  value ? h("span", { class: "fact", title: value }, h("span", { class: "label" }, label), value) : undefined;

/** How a run ended, by the log's word for it. */
const ENDS: Readonly<Record<string, string>> = {
  waiting: "ended with nothing left to do",
  "budget-spent": "ended with the budget spent",
  "decision-limit": "ended at the limit of decisions",
  stopped: "was stopped from outside",
  failed: "the run failed",
};

const state = (run: Run): string => {
  switch (run.wholeness.kind) {
    case "whole":
      return `complete: ${ENDS[run.end["end.status"] ?? ""] ?? run.end["end.status"] ?? "ended"}`;
    case "reading":
      return "reading …";
    case "unfinished":
      return "did not end";
    case "cut":
      return "cut short";
    case "damaged":
      return "damaged";
  }
};
