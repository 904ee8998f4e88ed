// Decision after decision, by the clock.

import type { Store } from "../state";
import { h } from "../ui/dom";
import type { Sides } from "./side";

export class Player {
  readonly button = h("button", { type: "button", class: "play", title: "Play (Space)", onclick: () => this.play(!this.store.view.playing) }, "▶");
  private timer: number | undefined;

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
  ) {}

  /** To a decision by its place, or to the nearest there is. */
  seek(index: number): void {
    this.store.set({ index: Math.max(0, Math.min(this.last, index)), option: undefined });
  }

  play(playing: boolean): void {
    window.clearInterval(this.timer);
    if (!this.sides.a?.run) return;
    if (playing && this.store.view.index >= this.last) this.seek(0);
    this.store.set({ playing });
    if (!playing) return;
    this.timer = window.setInterval(() => {
      if (this.store.view.index >= this.last) this.play(false);
      else this.seek(this.store.view.index + 1);
    }, 1000 / this.store.view.pace);
  }

  show(): void {
    this.button.textContent = this.store.view.playing ? "❚❚" : "▶";
  }

  private get last(): number {
    return (this.sides.a?.run?.moments.length ?? 1) - 1;
  }
}
