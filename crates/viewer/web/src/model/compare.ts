// Two runs held against each other, decision by decision.
//
// As `wisdom redecide` has it: two choices are alike if they do the same next and mean to visit the same places in the
// same order; places within the identity radius under the same directive are one. Names of goals are not compared,
// because each run gives its own.

import { sequence } from "./changes";
import { samePlace } from "./pairs";
import type { Pair } from "./pairs";
import type { Run } from "./run";
import type { Goal, GridSpec, Moment } from "./types";

const goalsOf = (moment: Moment): Goal[] => {
  const goals = new Map(moment.verdicts.map(({ goal }) => [goal.id, goal]));
  return sequence(moment).flatMap((id) => goals.get(id) ?? []);
};

/** The chosen sequences of two decisions, aligned by place: the least that must be put in and taken out. */
export const aligned = (a: Moment, b: Moment, grid: GridSpec, radiusM: number): Pair<Goal>[] => {
  const [left, right] = [goalsOf(a), goalsOf(b)];
  const alike = (i: number, j: number): boolean => {
    const [one, other] = [left[i], right[j]];
    return one !== undefined && other !== undefined && samePlace(one, other, grid, radiusM);
  };
  const width = right.length + 1;
  const best = new Uint16Array((left.length + 1) * width);
  const entry = (i: number, j: number): number => best[i * width + j] ?? 0;
  for (let i = left.length - 1; i >= 0; i--) {
    for (let j = right.length - 1; j >= 0; j--) {
      best[i * width + j] = alike(i, j) ? entry(i + 1, j + 1) + 1 : Math.max(entry(i + 1, j), entry(i, j + 1));
    }
  }
  const pairs: Pair<Goal>[] = [];
  let [i, j] = [0, 0];
  while (i < left.length || j < right.length) {
    if (alike(i, j) && entry(i, j) === entry(i + 1, j + 1) + 1) pairs.push({ a: left[i++], b: right[j++] });
    else if (j >= right.length || (i < left.length && entry(i + 1, j) >= entry(i, j + 1))) pairs.push({ a: left[i++] });
    else pairs.push({ b: right[j++] });
  }
  return pairs;
};

/** The turn, from 1, that a goal's place has in a decision's sequence, if it is there at all. */
export const turnOf = (goal: Goal, moment: Moment, grid: GridSpec, radiusM: number): number | undefined => {
  const at = goalsOf(moment).findIndex((other) => samePlace(goal, other, grid, radiusM));
  return at < 0 ? undefined : at + 1;
};

/** Whether two decisions chose alike. */
export const choseAlike = (a: Moment, b: Moment, grid: GridSpec, radiusM: number): boolean =>
  a.act.name === b.act.name && aligned(a, b, grid, radiusM).every((pair) => pair.a && pair.b);

/** How far apart goals of one place may be; on different ground no two places are one. */
export const placeRadiusM = (a: Run, b: Run): number => (sameGround(a.facts.grid, b.facts.grid) ? a.facts.identityRadiusM : -1);

/** Place of the first decision that the runs took otherwise, by number; none if they are alike as far as both go. */
export const firstDivergence = (a: Run, b: Run): number | undefined => {
  const radiusM = placeRadiusM(a, b);
  const most = Math.min(a.moments.length, b.moments.length);
  for (let i = 0; i < most; i++) {
    const [one, other] = [a.moments[i], b.moments[i]];
    if (one && other && !choseAlike(one, other, a.facts.grid, radiusM)) return i;
  }
  return a.moments.length === b.moments.length ? undefined : most;
};

/** Whether cells of the two runs are the same ground: without that, no place of one is a place of the other. */
export const sameGround = (a: GridSpec, b: GridSpec): boolean =>
  a.rows === b.rows && a.cols === b.cols && a.spacingM === b.spacingM && a.westM === b.westM && a.northM === b.northM;

/** What sets runs apart on purpose comes first. */
const FIRST: readonly string[] = ["rule", "policy", "seed"];
const rank = (key: string): number => (FIRST.includes(key) ? FIRST.indexOf(key) : FIRST.length);

/** Whether a fact is a digest: it says that something differs, not what. */
export const isDigest = (key: string): boolean => key.endsWith("digest");

/** What the files say of the runs, key by key: rule, policy and seed, then in the order of the first; nothing where a file does not tell. */
export const factPairs = (a: Run, b: Run): { key: string; a: string | undefined; b: string | undefined }[] =>
  [...new Set([...Object.keys(a.facts.run), ...Object.keys(b.facts.run)])]
    .filter((key) => !key.startsWith("end."))
    .sort((one, other) => rank(one) - rank(other))
    .map((key) => ({ key, a: a.facts.run[key], b: b.facts.run[key] }));
