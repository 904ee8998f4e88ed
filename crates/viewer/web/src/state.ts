// What the reader of the page looks at: one record, and who wants to know when it changes.

import type { Cell } from "./model/types";

export type Theme = "auto" | "light" | "dark";
export type Axis = "time" | "decision";
export type Tab = "goals" | "changes" | "plans" | "run" | "other";

export interface View {
  /** Place of the decision shown, from 0. */
  index: number;
  layer: string;
  shaded: boolean;
  /** In three dimensions. */
  solid: boolean;
  colours: "viridis" | "cividis" | "batlow";
  theme: Theme;
  axis: Axis;
  tab: Tab;
  playing: boolean;
  /** Decisions a second. */
  pace: number;
  /** The goal picked out. */
  goal: number | undefined;
  /** The member of the plan family picked out. */
  option: number | undefined;
  /** Where the map goes over from the first run to the second, as a share of its width. */
  wipe: number;
  /** The cell asked about. */
  probe: Cell | undefined;
}

type Listener = (changed: ReadonlySet<keyof View | "log">) => void;

export class Store {
  readonly view: View = {
    index: 0,
    layer: "map:interest",
    shaded: true,
    solid: false,
    colours: "viridis",
    theme: "auto",
    axis: "time",
    tab: "goals",
    playing: false,
    pace: 2,
    goal: undefined,
    option: undefined,
    wipe: 0.62,
    probe: undefined,
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
