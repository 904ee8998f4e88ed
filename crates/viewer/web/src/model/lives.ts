// Goal lifecycles: one lane a goal, from the decision that found it to the one that ended it.

import { stateOf } from "./states";
import type { GoalState } from "./states";
import type { Moment } from "./types";

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
  stretches: Stretch[];
  /** Whether the sequence ever held it. */
  planned: boolean;
  /** How and when it ended; absent while it is open. */
  end?: { state: GoalState; at: number };
}

/** The lives of all goals: first those that were ever in a plan, by when they ended, then the others. */
export const lives = (moments: readonly Moment[]): Life[] => {
  const all = new Map<number, Life>();
  moments.forEach((moment, index) => {
    for (const verdict of moment.verdicts) {
      const { id, directive } = verdict.goal;
      const life: Life = all.get(id) ?? { goal: id, directive, stretches: [], planned: false };
      all.set(id, life);
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
  });
  const ended = (life: Life): number => life.end?.at ?? Number.POSITIVE_INFINITY;
  const rank = (life: Life): number => (life.end?.state === "done" ? 0 : life.planned ? 1 : 2);
  return [...all.values()].sort((a, b) => rank(a) - rank(b) || ended(a) - ended(b) || a.goal - b.goal);
};
