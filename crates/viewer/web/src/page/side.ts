// A log that is open: its reader, its maps, and the run as far as it was read.

import { Run } from "../model/run";
import type { Plane } from "../model/plane";
import { Planes } from "../planes";
import { LogClient } from "../read/client";
import type { Origin, Tell } from "../read/protocol";
import type { Axis } from "../state";
import type { Relief } from "../view/relief";

/** The logs that are open: the first, and one to compare it with. */
export interface Sides {
  a: Side | undefined;
  b: Side | undefined;
}

export class Side {
  readonly client: LogClient;
  readonly planes: Planes;
  run: Run | undefined;
  /** Place of the decision shown, from 0. */
  index = 0;
  /** The layer shown, and the light on it. */
  plane: Plane | undefined;
  relief: Relief | undefined;
  private lighting: Promise<Relief | undefined> | undefined;
  private closed = false;

  constructor(origin: Origin, told: (side: Side, tell: Tell) => void) {
    this.client = new LogClient((tell) => {
      if (this.closed) return;
      this.take(tell);
      told(this, tell);
    });
    this.planes = new Planes(this.client);
    this.client.open(origin);
  }

  /** Asked for once: the elevation is logged once. */
  light(decision: number): Promise<Relief | undefined> {
    this.lighting ??= this.client.relief("map:elevation", decision).then((found) => {
      // Not in the log, or not yet read: asked again with the next decision.
      if (!found) this.lighting = undefined;
      else this.relief = found;
      return found;
    });
    return this.lighting;
  }

  /** Goes to where another run stands: at the same time, or at the same number. */
  follow(index: number, timeS: number, axis: Axis): void {
    if (!this.run) return;
    const last = this.run.moments.length - 1;
    this.index = axis === "time" ? this.run.indexAt(timeS) : Math.min(last, index);
  }

  close(): void {
    this.closed = true;
    this.client.close();
  }

  private take(tell: Tell): void {
    if (tell.kind === "facts") this.run = new Run(tell.facts);
    const { run } = this;
    if (!run) return;
    if (tell.kind === "batch") {
      run.add(tell.batch);
      run.planes = tell.planes;
      run.readBytes = tell.readBytes;
    }
    if (tell.kind === "end") {
      run.wholeness = tell.wholeness;
      run.end = tell.run;
      run.topics = tell.topics;
      run.planes = tell.planes;
    }
  }
}
