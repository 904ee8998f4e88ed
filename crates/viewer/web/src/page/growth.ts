// What of a log that comes in is worth a new picture: it comes in hundreds of pieces, few of which change what is seen.

import type { Layers } from "./layers";
import type { Side, Sides } from "./side";

/** How often the timeline follows a log that is being read. */
const PAUSE_MS = 250;

export class Growth {
  private seen = "";
  private drawnMs = Number.NEGATIVE_INFINITY;

  constructor(
    private readonly sides: Sides,
    private readonly layers: Layers,
  ) {}

  /** Whether the decision shown, its maps or the end of the log are new since last asked. */
  news(): boolean {
    const of = (side: Side | undefined): string => `${side?.run?.facts.name}/${side?.run?.moment(side.index)?.number}/${side?.run?.wholeness.kind}/${side?.plane !== undefined}`;
    const { a, b } = this.sides;
    const now = `${of(a)}/${of(b)}/${this.layers.choices.length}`;
    const news = now !== this.seen;
    this.seen = now;
    return news;
  }

  /** Whether it is time again to draw what grows steadily; at the end it always is. */
  due(): boolean {
    const reading = [this.sides.a, this.sides.b].some((side) => side?.run?.wholeness.kind === "reading");
    const now = performance.now();
    if (reading && now - this.drawnMs < PAUSE_MS) return false;
    this.drawnMs = now;
    return true;
  }
}
