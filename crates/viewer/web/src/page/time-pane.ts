// The pane of the timeline: the lanes, what plays them, by what they are laid out, and what is saved of them.

import type { Run } from "../model/run";
import type { Store } from "../state";
import { h } from "../ui/dom";
import { figureButtons, fileName } from "../ui/export";
import { TimelineView } from "../view/timeline";
import type { TimelineHandlers } from "../view/timeline";
import type { Player } from "./player";
import { timeGrip } from "./time-grip";
import type { Sides } from "./side";

export class TimePane {
  readonly element: HTMLElement;
  private readonly timeline: TimelineView;
  private readonly axisButton = h("button", { type: "button", title: "Axis of the timeline (t)", onclick: () => this.swapAxis() });

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
    player: Player,
    handlers: TimelineHandlers,
  ) {
    this.timeline = new TimelineView(h("canvas", { class: "lanes", tabindex: 0, "aria-label": "Timeline of decisions, events and goals. Keys: up and down scroll the goals" }), handlers);
    const buttons = figureButtons("the timeline", (ending) => this.fileName(ending), () => this.timeline.figure(this.label));
    this.element = h("section", { class: "time-pane", "aria-label": "Timeline" }, timeGrip(() => this.element), this.timeline.canvas, h("div", { class: "time-tools" }, player.elements, this.axisButton, buttons));
    this.axisLabel();
  }

  show(run: Run): void {
    const { a, b } = this.sides;
    const { axis, goal, subject } = this.store.view;
    this.timeline.show({ run, index: a?.index ?? 0, axis, goal, lead: b?.run ? subject : "a", ...(b?.run && b.run.moments.length > 0 ? { other: { run: b.run, index: b.index } } : {}) });
    this.axisLabel();
  }

  redraw(): void {
    this.timeline.redraw();
  }

  swapAxis(): void {
    this.store.set({ axis: this.store.view.axis === "time" ? "decision" : "time" });
  }

  /** All lanes, in pieces that fit a sheet. */
  sheets(width: number, height: number): SVGSVGElement[] {
    return this.timeline.figures(this.label, width, height);
  }

  private axisLabel(): void {
    this.axisButton.textContent = this.store.view.axis === "time" ? "by time" : "by decision";
  }

  private get label(): string {
    const { a, b } = this.sides;
    const names = [a, b].flatMap((side) => side?.run?.facts.run.mission ?? side?.run?.facts.name ?? []);
    return `Decisions, events and goals of ${names.join(" and ")}`;
  }

  private fileName(ending: string): string {
    const run = this.sides.a?.run;
    return run ? fileName(run, undefined, "timeline", ending) : `timeline.${ending}`;
  }
}
