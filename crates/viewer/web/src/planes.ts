// Planes at hand: asked of the reader once, and kept while they are near.

import { difference } from "./model/plane";
import type { Plane } from "./model/plane";
import type { LogClient } from "./read/client";

const KEPT = 40;
/** A layer that is made here: interest less that of the decision before. */
export const DIFFERENCE = "made:change";
/** And one of two runs: interest of the first less that of the second. */
export const BETWEEN = "made:between";

export class Planes {
  private readonly kept = new Map<string, Promise<Plane | undefined>>();

  constructor(private readonly client: LogClient) {}

  /** A layer at a decision, by its number. */
  at(layer: string, decision: number): Promise<Plane | undefined> {
    const key = `${layer}@${decision}`;
    const known = this.kept.get(key);
    if (known) {
      // Looked at last, dropped last.
      this.kept.delete(key);
      this.kept.set(key, known);
      return known;
    }
    const asked = layer === DIFFERENCE ? this.change(decision) : this.client.plane(layer, decision);
    this.kept.set(key, asked);
    asked.catch(() => this.kept.delete(key));
    const oldest = this.kept.keys().next().value;
    if (this.kept.size > KEPT && oldest !== undefined) this.kept.delete(oldest);
    return asked;
  }

  private async change(decision: number): Promise<Plane | undefined> {
    const after = await this.at("map:interest", decision);
    const before = await this.at("map:interest", decision - 1);
    return after && before && difference(after, before);
  }
}
