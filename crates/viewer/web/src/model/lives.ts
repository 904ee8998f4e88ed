// Goal lifecycles: one lane a goal, from the decision that found it to the one that ended it.

import { stateOf } from "./states";
import type { GoalState } from "./states";
import type { Cell, Moment } from "./types";

/** A stretch of decisions through which a goal was in one state. */
export interface Stretch {
  state: GoalState;
  /** Index of the first decision. */
  from: number;
  /** Index after the last. */
  to: number;
}

export interface Life {
  goal: number;
  directive: string;
  /** Its target as it was found. */
  target: Cell;
  /** Indices of the decisions that spoke of it first and last. */
  first: number;
  last: number;
  stretches: Stretch[];
  /** Whether the sequence ever held it. */
  planned: boolean;
  /** How and when it ended; absent while it is open. */
  end?: { state: GoalState; at: number };
}

/** The lives of a run's goals, as far as its decisions were taken in. */
export class Lives {
  private readonly lives = new Map<number, Life>();
  private taken = 0;
  private sorted: readonly Life[] | undefined;

  /** Takes in the decisions that are new since last time. */
  take(moments: readonly Moment[]): this {
    for (; this.taken < moments.length; this.taken++) {
      const moment = moments[this.taken];
      if (moment) this.decision(moment, this.taken);
    }
    return this;
  }

  of(goal: number): Life | undefined {
    return this.lives.get(goal);
  }

  /** In the order in which goals were found. */
  all(): Iterable<Life> {
    return this.lives.values();
  }

  /** First those that were ever in a plan, by when they ended, then the others. */
  get lanes(): readonly Life[] {
    const ended = (life: Life): number => life.end?.at ?? Number.POSITIVE_INFINITY;
    const rank = (life: Life): number => (life.end?.state === "done" ? 0 : life.planned ? 1 : 2);
    // Of two open goals neither ends first: infinity less infinity is no number.
    const sooner = (a: Life, b: Life): number => (ended(a) === ended(b) ? 0 : ended(a) - ended(b));
    this.sorted ??= [...this.lives.values()].sort((a, b) => rank(a) - rank(b) || sooner(a, b) || a.goal - b.goal);
    return this.sorted;
  }

  private decision(moment: Moment, index: number): void {
    this.sorted = undefined;
    for (const verdict of moment.verdicts) {
      const { id, directive, target } = verdict.goal;
      const life: Life = this.lives.get(id) ?? { goal: id, directive, target, first: index, last: index, stretches: [], planned: false };
      this.lives.set(id, life);
      life.last = index;
      if (life.end) continue;
      life.directive = directive;
      const state = stateOf(verdict, moment);
      if (state === "done" || state === "dropped") {
        life.end = { state, at: index };
        continue;
      }
      if (state !== "deferred") life.planned = true;
      const last = life.stretches.at(-1);
      if (last && last.state === state && last.to === index) last.to = index + 1;
      else life.stretches.push({ state, from: index, to: index + 1 });
    }
  }
}

export const lives = (moments: readonly Moment[]): readonly Life[] => new Lives().take(moments).lanes;
