// What the reader of the page looks at: one record, and who wants to know when it changes.

import type { Cell } from "./model/types";

export type Theme = "auto" | "light" | "dark";
export type Axis = "time" | "decision";
/** What of a layer is shown: its value, its change since the last decision, or how two runs differ in it. */
export type Aspect = "value" | "change" | "between";
/** How two maps share the room. */
export type Split = "wipe" | "halves";
export type Tab = "goals" | "changes" | "plans" | "run" | "other";

export interface View {
  /** Place of the decision shown, from 0, in the run that leads. */
  index: number;
  layer: string;
  aspect: Aspect;
  shaded: boolean;
  /** In three dimensions. */
  solid: boolean;
  /** By how much heights are stretched there; as much as shows them well, if nothing is said. */
  heights: number | undefined;
  colours: "viridis" | "cividis" | "batlow";
  theme: Theme;
  axis: Axis;
  tab: Tab;
  playing: boolean;
  /** Decisions a second. */
  pace: number;
  /** Whether playing begins anew at the end. */
  loop: boolean;
  /** The goal picked out. */
  goal: number | undefined;
  /** The member of the plan family picked out. */
  option: number | undefined;
  /** Where the map goes over from the first run to the second, as a share of its width. */
  wipe: number;
  split: Split;
  /** The ways of all members of the plan family. */
  alternatives: boolean;
  /** The cell asked about, and of which run. */
  probe: Cell | undefined;
  probed: "a" | "b";
  /** The run that the decision panel tells of; decision, goal and plan picked out are this run's. */
  subject: "a" | "b";
}

type Listener = (changed: ReadonlySet<keyof View | "log">) => void;

export class Store {
  readonly view: View = {
    index: 0,
    layer: "map:interest",
    aspect: "value",
    shaded: true,
    solid: false,
    heights: undefined,
    colours: "viridis",
    theme: "auto",
    axis: "time",
    tab: "goals",
    playing: false,
    pace: 2,
    loop: false,
    goal: undefined,
    option: undefined,
    wipe: 0.62,
    split: "wipe",
    alternatives: false,
    probe: undefined,
    probed: "a",
    subject: "a",
  };
  private readonly listeners: Listener[] = [];
  private changed = new Set<keyof View | "log">();
  private waiting = false;

  /** Changes the view; who listens is told once, before the next frame. */
  set(change: Partial<View>): void {
    for (const key of Object.keys(change) as (keyof View)[]) {
      if (this.view[key] === change[key]) continue;
      this.changed.add(key);
    }
    Object.assign(this.view, change);
    this.tell();
  }

  /** Says that more of the log is there. */
  grown(): void {
    this.changed.add("log");
    this.tell();
  }

  listen(listener: Listener): void {
    this.listeners.push(listener);
  }

  private tell(): void {
    if (this.waiting || this.changed.size === 0) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      const changed = this.changed;
      this.changed = new Set();
      for (const listener of this.listeners) listener(changed);
    });
  }
}
