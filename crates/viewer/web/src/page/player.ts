// Decision after decision, by the clock: how fast, and whether it begins anew at the end.

import type { Store } from "../state";
import { h } from "../ui/dom";
import { leadOf } from "./lead";
import type { Sides } from "./side";

/** Decisions a second. */
const PACES: readonly number[] = [0.5, 1, 2, 4, 8, 16, 32];

export class Player {
  private readonly button = h("button", { type: "button", class: "play", onclick: () => this.play(!this.store.view.playing) });
  private readonly paces = h("select", { class: "pace", title: "Decisions a second (, and .)", "aria-label": "Decisions a second" }, PACES.map((pace) => h("option", { value: pace }, `${pace}/s`)));
  private readonly loopButton = h("button", { type: "button", title: "Begin anew at the end (r)", "aria-label": "Begin anew at the end", onclick: () => this.loop() }, "↻");
  readonly elements: readonly HTMLElement[] = [this.button, this.paces, this.loopButton];
  private timer: number | undefined;

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
  ) {
    this.paces.addEventListener("change", () => this.store.set({ pace: Number(this.paces.value) }));
    this.show();
  }

  /** To a decision by its place, or to the nearest there is. */
  seek(index: number): void {
    this.store.set({ index: Math.max(0, Math.min(this.last, index)), option: undefined });
  }

  play(playing: boolean): void {
    if (!this.sides.a?.run) return;
    if (playing && this.store.view.index >= this.last) this.seek(0);
    this.store.set({ playing });
    this.tick(playing);
  }

  loop(): void {
    this.store.set({ loop: !this.store.view.loop });
  }

  /** To the next faster or slower pace. */
  hurry(by: number): void {
    const now = PACES.indexOf(this.store.view.pace);
    this.store.set({ pace: PACES[Math.max(0, Math.min(PACES.length - 1, now + by))] ?? 2 });
  }

  /** Shows what was set by button or key, and goes on at that pace. */
  show(): void {
    const { playing, pace, loop } = this.store.view;
    this.button.textContent = playing ? "❚❚" : "▶";
    this.button.title = playing ? "Stop (Space)" : "Play (Space)";
    this.button.setAttribute("aria-label", playing ? "Stop" : "Play");
    this.paces.value = String(pace);
    this.loopButton.setAttribute("aria-pressed", String(loop));
    this.tick(playing);
  }

  private tick(playing: boolean): void {
    window.clearInterval(this.timer);
    if (playing) this.timer = window.setInterval(() => this.next(), 1000 / this.store.view.pace);
  }

  private next(): void {
    const { index, loop } = this.store.view;
    if (index < this.last) this.seek(index + 1);
    else if (loop) this.seek(0);
    else this.play(false);
  }

  private get last(): number {
    return Math.max(0, (leadOf(this.sides, this.store.view)?.run?.moments.length ?? 1) - 1);
  }
}
