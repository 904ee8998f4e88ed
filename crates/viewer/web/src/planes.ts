// Planes at hand: asked of the reader or of the derived source once, and kept while they are near.

import type { Derived } from "./derived/types";
import { difference, differing } from "./model/plane";
import type { Plane } from "./model/plane";
import type { LogClient } from "./read/client";

/** Cells kept, of four bytes each: all layers of a decision of a large run, or many decisions of a small one. */
const KEPT_CELLS = 40e6;
/** Begins the name of a layer that is no map of the log. */
export const DERIVED = "derived:";

interface Kept {
  plane: Promise<Plane | undefined>;
  cells: number;
}

export class Planes {
  private readonly kept = new Map<string, Kept>();
  private cells = 0;

  constructor(
    private readonly client: LogClient,
    private readonly derived: Derived,
  ) {}

  /** A layer at a decision, by its number. */
  at(layer: string, decision: number): Promise<Plane | undefined> {
    return this.keep(`${layer}@${decision}`, () =>
      layer.startsWith(DERIVED) ? this.derived.plane(layer.slice(DERIVED.length), decision) : this.client.plane(layer, decision),
    );
  }

  /** How a layer changed from one decision to a later one; of classes, where they changed. */
  change(layer: string, before: number, decision: number, classes: boolean): Promise<Plane | undefined> {
    return this.keep(`${layer}@${before}-${decision}`, async () => {
      const [was, is] = [await this.at(layer, before), await this.at(layer, decision)];
      return was && is && (classes ? differing(is, was) : difference(is, was));
    });
  }

  private keep(key: string, ask: () => Promise<Plane | undefined>): Promise<Plane | undefined> {
    const known = this.kept.get(key);
    if (known) {
      // Looked at last, dropped last.
      this.kept.delete(key);
      this.kept.set(key, known);
      return known.plane;
    }
    const asked: Kept = { plane: ask(), cells: 0 };
    this.kept.set(key, asked);
    asked.plane.then(
      // What is not there yet may come: a log is shown while it is read.
      (plane) => (plane ? this.weigh(key, asked, plane.values.length) : this.kept.delete(key)),
      () => this.kept.delete(key),
    );
    return asked.plane;
  }

  private weigh(key: string, one: Kept, cells: number): void {
    if (this.kept.get(key) !== one) return;
    one.cells = cells;
    this.cells += cells;
    for (const [oldest, { cells: freed }] of this.kept) {
      if (this.cells <= KEPT_CELLS || oldest === key) break;
      this.kept.delete(oldest);
      this.cells -= freed;
    }
  }
}
