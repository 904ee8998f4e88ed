// What a decision changed against the one before.

import type { Cell, Moment, Verdict } from "./types";

export type ChangeKind = "found" | "entered" | "left" | "moved" | "altered" | "done" | "dropped";

/** One goal that is not as it was. */
export interface GoalChange {
  kind: ChangeKind;
  goal: number;
  verdict: Verdict;
  /** Turns in the sequences, from 0. */
  from?: number;
  to?: number;
  /** Where its target was, if that moved. */
  targetWas?: Cell;
  /** Its prize before. */
  prizeWas?: number;
}

/** Prizes that differ by less are the same to a reader. */
const SAME_PRIZE = 0.005;

/**
 * Goals that keep their order from one sequence to the other: a longest common subsequence. The rest of what both
 * hold has moved; so one goal that is put first moves itself, not all the others.
 */
export const keptOrder = (before: readonly number[], after: readonly number[]): Set<number> => {
  const width = after.length + 1;
  const best = new Uint16Array((before.length + 1) * width);
  const entry = (i: number, j: number): number => best[i * width + j] ?? 0;
  for (let i = before.length - 1; i >= 0; i--) {
    for (let j = after.length - 1; j >= 0; j--) {
      best[i * width + j] = before[i] === after[j] ? entry(i + 1, j + 1) + 1 : Math.max(entry(i + 1, j), entry(i, j + 1));
    }
  }
  const kept = new Set<number>();
  for (let i = 0, j = 0; i < before.length && j < after.length; ) {
    const goal = before[i];
    if (goal !== undefined && goal === after[j]) {
      kept.add(goal);
      i += 1;
      j += 1;
    } else if (entry(i + 1, j) >= entry(i, j + 1)) i += 1;
    else j += 1;
  }
  return kept;
};

/** The chosen sequence, as goal numbers. */
export const sequence = (moment: Moment): number[] =>
  moment.verdicts
    .filter((verdict) => verdict.turn !== undefined)
    .sort((a, b) => (a.turn ?? 0) - (b.turn ?? 0))
    .map((verdict) => verdict.goal.id);

/** The next decision (or, backwards, the one before) at which a goal was added or dropped; nothing if there is none. */
export const nextTurn = (moments: readonly Moment[], from: number, by: 1 | -1): number | undefined => {
  for (let i = from + by; i >= 0 && i < moments.length; i += by) {
    if (moments[i]?.verdicts.some(({ action }) => action === "add" || action === "drop")) return i;
  }
  return undefined;
};

const ORDER: readonly ChangeKind[] = ["done", "dropped", "entered", "left", "moved", "altered", "found"];

/** All goals that changed, by kind and then by number. */
export const changes = (now: Moment, before: Moment | undefined): GoalChange[] => {
  const [was, is] = [before ? sequence(before) : [], sequence(now)];
  const kept = keptOrder(was, is);
  const old = new Map(before?.verdicts.map((verdict) => [verdict.goal.id, verdict]));
  const found = now.verdicts.flatMap((verdict): GoalChange[] => {
    const goal = verdict.goal.id;
    const [from, to] = [was.indexOf(goal), is.indexOf(goal)];
    const previous = old.get(goal);
    const change = (kind: ChangeKind): GoalChange[] => {
      const there = previous?.goal;
      const moved = there && (there.target.row !== verdict.goal.target.row || there.target.col !== verdict.goal.target.col);
      const worth = there && Math.abs(there.prize - verdict.goal.prize) >= SAME_PRIZE;
      return [
        {
          kind,
          goal,
          verdict,
          from: from < 0 ? undefined : from,
          to: to < 0 ? undefined : to,
          targetWas: moved ? there.target : undefined,
          prizeWas: worth ? there.prize : undefined,
        },
      ];
    };
    if (verdict.action === "achieve") return change("done");
    if (verdict.action === "drop") return change("dropped");
    if (from < 0 && to >= 0) return change("entered");
    if (from >= 0 && to < 0) return change("left");
    if (from >= 0 && !kept.has(goal)) return change("moved");
    if (!previous) return change("found");
    const altered = verdict.changes.length > 0 || Math.abs(previous.goal.prize - verdict.goal.prize) >= SAME_PRIZE;
    return altered ? change("altered") : [];
  });
  return found.sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind) || a.goal - b.goal);
};
