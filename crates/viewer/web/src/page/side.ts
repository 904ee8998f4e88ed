// A log that is open: its reader, its maps, what is derived from it, and the run as far as it was read.

import { PlanesInside } from "../derived/inside";
import { derivedFrom } from "../derived/source";
import type { Derived, Index } from "../derived/types";
import type { Given } from "../given";
import { sameGround } from "../model/compare";
import { Run } from "../model/run";
import type { Plane } from "../model/plane";
import type { Cell } from "../model/types";
import { Planes } from "../planes";
import { LogClient } from "../read/client";
import type { Tell } from "../read/protocol";
import type { Axis } from "../state";
import type { Relief } from "../view/relief";

/** The logs that are open: the first, and one to compare it with. */
export interface Sides {
  a: Side | undefined;
  b: Side | undefined;
}

/** Whether two runs stand on different ground, so that no cell of one is a cell of the other. */
export const apart = ({ a, b }: Sides): boolean => a?.run !== undefined && b?.run !== undefined && !sameGround(a.run.facts.grid, b.run.facts.grid);

let opened = 0;

export class Side {
  /** Unlike that of any other log that was open before. */
  readonly serial = ++opened;
  readonly client: LogClient;
  readonly derived: Derived;
  readonly planes: Planes;
  run: Run | undefined;
  /** Place of the decision shown, from 0. */
  index = 0;
  /** The layer shown, and the light on it. */
  plane: Plane | undefined;
  /** Place of the decision that the layer shown is of: it comes later than the decision itself. */
  planeIndex: number | undefined;
  /** Why there is no such layer of this run, if there is none. */
  lacks = "";
  relief: Relief | undefined;
  /** What can be derived, once it is known. */
  derivable: Index | undefined;
  private readonly inside: PlanesInside | undefined;
  /** The whole ways of a family's plans; none if they are nowhere to be had. */
  private family: { decision: number; ways: readonly (readonly Cell[])[] | undefined } | undefined;
  private familyAsked = -1;
  private familyUnderWay = false;
  private lighting: Promise<Relief | undefined> | undefined;
  private closed = false;

  constructor(given: Given, told: (side: Side, tell: Tell) => void, learned: () => void) {
    this.client = new LogClient((tell) => {
      if (this.closed) return;
      this.take(tell);
      told(this, tell);
    });
    const { supply } = given;
    this.inside = supply.kind === "embedded" && supply.planes ? new PlanesInside(supply.planes) : undefined;
    this.derived = derivedFrom(supply, this.inside);
    this.planes = new Planes(this.client, this.derived);
    this.client.open(given.origin);
    const learn = (index: Index): void => {
      this.derivable = index;
      if (!this.closed) learned();
    };
    this.derived.index().then(learn, (error: Error) => learn({ unavailable: error.message }));
  }

  /** Asked for once: the elevation is logged once. */
  light(decision: number): Promise<Relief | undefined> {
    this.lighting ??= this.client.relief("map:elevation", decision).then((found) => {
      // Not in the log, or not yet read: asked again with the next decision.
      if (!found) this.lighting = undefined;
      else this.relief = found;
      return found;
    });
    this.lighting.catch(() => (this.lighting = undefined));
    return this.lighting;
  }

  /** Goes to where another run stands: at the same time, or at the same number. */
  follow(index: number, timeS: number, axis: Axis): void {
    if (!this.run) return;
    const last = this.run.moments.length - 1;
    this.index = axis === "time" ? this.run.indexAt(timeS) : Math.min(last, index);
  }

  /** The ways of the family at the decision shown, if they are to be had. */
  get ways(): readonly (readonly Cell[])[] | "pending" | undefined {
    return this.family && this.family.decision === this.run?.moment(this.index)?.number ? this.family.ways : "pending";
  }

  /** Gets the ways of the family at the decision shown, and says when they have come. */
  meetFamily(come: () => void): void {
    const decision = this.run?.moment(this.index)?.number;
    // One at a time: of decisions that were stepped past nobody wants to know.
    if (decision === undefined || this.familyAsked === decision || this.familyUnderWay) return;
    this.familyAsked = decision;
    this.familyUnderWay = true;
    const keep = (ways: readonly (readonly Cell[])[] | undefined): void => {
      this.familyUnderWay = false;
      if (this.closed) return;
      this.family = { decision, ways };
      come();
    };
    this.derived.family(decision).then(keep, () => keep(undefined));
  }

  /** The layer at the decision shown: its value, or its change since the decision before. */
  layer(id: string, change: boolean, classes: boolean): Promise<Plane | undefined> {
    const [moment, before] = [this.run?.moment(this.index), this.run?.moment(this.index - 1)];
    if (!moment || (change && !before)) return Promise.resolve(undefined);
    return change && before ? this.planes.change(id, before.number, moment.number, classes) : this.planes.at(id, moment.number);
  }

  close(): void {
    this.closed = true;
    this.client.close();
    this.inside?.close();
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
      run.checks = tell.checks;
      run.planes = tell.planes;
    }
  }
}
