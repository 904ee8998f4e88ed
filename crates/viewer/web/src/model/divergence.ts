// Two decisions held against each other term by term, in the order in which a decision comes about: why it was due,
// what was known, what each goal was worth and what was said of it, and what was chosen.

import { sequence } from "./changes";
import { paired } from "./pairs";
import type { Pair } from "./pairs";
import type { Run } from "./run";
import { reliability } from "./states";
import type { Goal, GridSpec, Moment, Term, Trigger, Verdict } from "./types";

/** What a term is measured in. */
export type Quantity = "text" | "share" | "chance" | "count" | "time" | "energy" | "length" | "data" | "angle" | "plain";

/** One term; a side is absent where that decision has no such number. */
export interface Row {
  label: string;
  of: Quantity;
  a?: number | string;
  b?: number | string;
  /** Numbers are the same if they are to the last bit; goals are if they are of one place, whatever their names. */
  same: boolean;
}

export interface Section {
  title: string;
  rows: Row[];
  /** The goal that the section is about, by its names in both runs. */
  goal?: Pair<Goal>;
  /** Whether the verdict on it differs, not only its numbers. */
  judged: boolean;
}

/** How the decision's own records are put in words. */
export interface Words {
  trigger(of: Trigger): string;
  reason(of: Verdict): string;
  goal(id: number): string;
}

/** One decision of a run. */
export interface Taken {
  run: Run;
  index: number;
  moment: Moment;
}

const number = (label: string, of: Quantity, a: number | undefined, b: number | undefined): Row => ({ label, of, a, b, same: a === b });
const text = (label: string, a: string, b: string, same = a === b): Row => ({ label, of: "text", a, b, same });

/** The second run's goal numbers as the first one's, where they are of one place; others as numbers that no goal has. */
const namesakes = (pairs: readonly Pair<{ id: number }>[]): ((id: number) => number) => {
  const known = new Map(pairs.flatMap(({ a, b }) => (a && b ? [[b.id, a.id] as const] : [])));
  return (id) => known.get(id) ?? -1 - id;
};

const goalsOf = ({ run, index }: Taken): Goal[] => [...run.verdictsUpTo(index).values()].map(({ verdict }) => verdict.goal);

/** All sections, equal terms included. */
export const divergence = (a: Taken, b: Taken, grid: GridSpec, radiusM: number, words: Words): Section[] => {
  const pairs = paired(goalsOf(a), goalsOf(b), grid, radiusM);
  const inA = namesakes(pairs);
  return [due(a.moment, b.moment, words, inA), known(a.moment, b.moment, words, inA), ...goals(a, b, pairs, words, inA), chosen(a.moment, b.moment, words, inA)];
};

const section = (title: string, rows: Row[]): Section => ({ title, rows, judged: false });

const due = (a: Moment, b: Moment, words: Words, inA: (id: number) => number): Section => {
  const told = (moment: Moment, name: (id: number) => number): string =>
    moment.triggers.map((one) => words.trigger(one.goal === undefined ? one : { ...one, goal: name(one.goal) })).join("; ");
  const itself = (id: number): number => id;
  return section("Why it was due", [text("trigger", told(a, itself), told(b, itself), told(a, itself) === told(b, inA))]);
};

const known = (a: Moment, b: Moment, words: Words, inA: (id: number) => number): Section => {
  const underway = ({ underway: goal }: Moment): string => (goal === undefined ? "none" : words.goal(goal));
  const facts = (moment: Moment): string => [...moment.facts].sort().join(", ") || "none";
  return section("What was known", [
    number("rover, row", "count", a.pose.row, b.pose.row),
    number("rover, column", "count", a.pose.col, b.pose.col),
    number("heading", "angle", a.headingRad, b.headingRad),
    number("time spent", "time", a.spent.timeS, b.spent.timeS),
    number("energy spent", "energy", a.spent.energyJ, b.spent.energyJ),
    number("data taken", "data", a.spent.dataMb, b.spent.dataMb),
    number("way driven", "length", a.spent.lengthM, b.spent.lengthM),
    text("facts", facts(a), facts(b)),
    text("goal under way", underway(a), underway(b), a.underway === (b.underway === undefined ? undefined : inA(b.underway))),
    number("ground seen", "share", a.seen, b.seen),
    number("background interest", "share", a.background, b.background),
    number("maxima found", "count", a.sites, b.sites),
    number("goals sequenced", "count", a.shortlist, b.shortlist),
  ]);
};

/** What only the verdict knows of a goal at a decision. */
interface Judged {
  verdict: Verdict;
  reliability?: number;
}

const judgedAt = ({ moment }: Taken): Map<number, Judged> =>
  new Map(moment.verdicts.map((verdict) => [verdict.goal.id, { verdict, reliability: reliability(verdict, moment) }]));

const goals = (a: Taken, b: Taken, pairs: readonly Pair<Goal>[], words: Words, inA: (id: number) => number): Section[] => {
  const [left, right] = [judgedAt(a), judgedAt(b)];
  return pairs.flatMap(({ a: one, b: other }) => {
    const [ja, jb] = [one && left.get(one.id), other && right.get(other.id)];
    // Ended before in both: nothing was said of it.
    if (!ja && !jb) return [];
    const goal: Pair<Goal> = { ...(ja && one ? { a: one } : {}), ...(jb && other ? { b: other } : {}) };
    const rows = goalRows(ja, jb, words, inA);
    const judged = rows.some(({ label, same }) => !same && (label === "verdict" || label === "place in the order"));
    return [{ title: "", goal, rows, judged }];
  });
};

const goalRows = (a: Judged | undefined, b: Judged | undefined, words: Words, inA: (id: number) => number): Row[] => {
  const [one, other] = [a?.verdict.goal, b?.verdict.goal];
  const reason = (of: Verdict | undefined, name: (id: number) => number): string =>
    of ? words.reason(of.other === undefined ? of : { ...of, other: name(of.other) }) : "not known";
  const itself = (id: number): number => id;
  const turn = (of: Judged | undefined): number | undefined => (of?.verdict.turn === undefined ? undefined : of.verdict.turn + 1);
  return [
    number("target, row", "count", one?.target.row, other?.target.row),
    number("target, column", "count", one?.target.col, other?.target.col),
    number("interest", "share", one?.interest, other?.interest),
    number("prize", "share", one?.prize, other?.prize),
    number("prominence", "share", one?.prominence, other?.prominence),
    number("ignorance", "share", one?.ignorance, other?.ignorance),
    number("paradox", "share", one?.paradox, other?.paradox),
    number("contradiction", "share", one?.contradiction, other?.contradiction),
    number("reliability so far", "chance", a?.reliability, b?.reliability),
    text("verdict", a?.verdict.action ?? "not known", b?.verdict.action ?? "not known"),
    text("reason", reason(a?.verdict, itself), reason(b?.verdict, itself), reason(a?.verdict, itself) === reason(b?.verdict, inA)),
    ...termRows(a?.verdict.terms ?? [], b?.verdict.terms ?? []),
    number("place in the order", "count", turn(a), turn(b)),
  ];
};

const UNITS: readonly [RegExp, Quantity][] = [
  [/_j$/, "energy"],
  [/_s$/, "time"],
  [/_m$/, "length"],
  [/_mb$/, "data"],
];

/** The numbers that a reason gives, and what they were compared with. Interest and prize have rows of their own. */
const termRows = (a: readonly Term[], b: readonly Term[]): Row[] => {
  const names = [...new Set([...a, ...b].map(({ name }) => name))];
  return names.flatMap((name) => {
    const [one, other] = [a.find((term) => term.name === name), b.find((term) => term.name === name)];
    const of = UNITS.find(([ending]) => ending.test(name))?.[1] ?? "plain";
    const label = name.replace(/_(j|s|m|mb)$/, "").replaceAll("_", " ");
    const value = name === "interest" || name === "prize" ? [] : [number(`its ${label}`, of, one?.value, other?.value)];
    const limited = one?.limit !== undefined || other?.limit !== undefined;
    return limited ? [...value, number(`its ${label}, limit`, of, one?.limit, other?.limit)] : value;
  });
};

const chosen = (a: Moment, b: Moment, words: Words, inA: (id: number) => number): Section => {
  const [one, other] = [a.family[a.chosen], b.family[b.chosen]];
  const act = ({ act: { name, goal } }: Moment): string => (goal === undefined ? name : `${name} ${words.goal(goal)}`);
  const order = (moment: Moment): string => sequence(moment).map(words.goal).join(" › ") || "nothing";
  const sameGoal = a.act.goal === (b.act.goal === undefined ? undefined : inA(b.act.goal));
  const sameOrder = sequence(a).join() === sequence(b).map(inA).join();
  return section("What was chosen", [
    number("plans in the family", "count", a.family.length, b.family.length),
    text("search", a.proof, b.proof),
    number("bound on the value", "plain", a.bound, b.bound),
    text("committed plan held", a.held ? "yes" : "no", b.held ? "yes" : "no"),
    text("sequence", order(a), order(b), sameOrder),
    number("value", "plain", one?.value, other?.value),
    number("prize", "plain", one?.prize, other?.prize),
    number("expected interest", "plain", one?.expected, other?.expected),
    number("reliability", "chance", one?.reliability, other?.reliability),
    number("energy", "energy", one?.energyJ, other?.energyJ),
    number("time", "time", one?.timeS, other?.timeS),
    number("data", "data", one?.dataMb, other?.dataMb),
    number("way", "length", one?.lengthM, other?.lengthM),
    text("act", act(a), act(b), a.act.name === b.act.name && sameGoal),
  ]);
};
