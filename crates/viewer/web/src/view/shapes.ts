// What is drawn over the ground: ways, goals and the rover, as shapes for any pen.

import { sequence } from "../model/changes";
import type { Run } from "../model/run";
import { stateOf } from "../model/states";
import type { GoalState } from "../model/states";
import type { Cell, Moment } from "../model/types";
import { OKABE } from "./colour";

/** What of a run is drawn. */
export interface Marked {
  run: Run;
  index: number;
  /** The goal picked out. */
  goal: number | undefined;
  /** The member of the family picked out. */
  option: number | undefined;
  /** Whether all members of the family are drawn. */
  alternatives: boolean;
  /** Their whole ways, where they are known. */
  family: readonly (readonly Cell[])[] | undefined;
}

export interface Way {
  kind: "way";
  /** What it is, for a reader of the drawing's text. */
  what: "driven" | "next leg" | "plan" | "alternative" | "picked alternative" | "pose to goal";
  /** One line, or several that look alike. */
  lines: readonly (readonly Cell[])[];
  colour: string;
  width: number;
  /** Broken, where only its ends are known. */
  dash: readonly number[];
  opacity: number;
  /** Of the light line beneath, which keeps it apart from any ground. */
  casing: number;
}

export interface Mark {
  kind: "mark";
  goal: number;
  cell: Cell;
  state: GoalState;
  /** Its place in the chosen sequence, from 0. */
  turn: number | undefined;
  picked: boolean;
}

export interface Rover {
  kind: "rover";
  cell: Cell;
  headingRad: number;
}

export interface Dot {
  kind: "dot";
  cell: Cell;
  colour: string;
}

export type Shape = Way | Mark | Rover | Dot;

/** The rover, its tip to where it faces when headings turn clockwise from north. */
export const ROVER_PATH = "M0 -10L7.5 8L0 4.2L-7.5 8Z";

interface Kept {
  marked: Marked;
  outcomes: number;
  shapes: Shape[];
}

/** Shapes as they were made last: of a long run they are many, and panning asks for them at every frame. */
const kept = new WeakMap<Run, Kept>();

/** From the lowest to the one on top. */
export const shapes = (marked: Marked): Shape[] => {
  const known = kept.get(marked.run);
  const outcomes = marked.run.outcomes.size;
  const keys = ["index", "goal", "option", "alternatives", "family"] as const;
  if (known && known.outcomes === outcomes && keys.every((key) => known.marked[key] === marked[key])) return known.shapes;
  const made = make(marked);
  kept.set(marked.run, { marked, outcomes, shapes: made });
  return made;
};

const make = (marked: Marked): Shape[] => {
  const moment = marked.run.moment(marked.index);
  if (!moment) return [];
  return [
    way("driven", once(marked.run.tracks(marked.index)), OKABE.blue, 2.2),
    ...alternatives(marked, moment),
    ...reaches(moment),
    ...legs(moment),
    ...picked(marked, moment),
    ...marks(marked, moment),
    { kind: "rover", cell: moment.pose, headingRad: moment.headingRad },
  ];
};

const way = (what: Way["what"], lines: readonly (readonly Cell[])[], colour: string, width: number, dash: readonly number[] = [], opacity = 1): Way => ({ kind: "way", what, lines, colour, width, dash, opacity, casing: opacity < 1 ? FAINT_CASING : CASING });

/** Of drives along the same cells one is drawn. */
const once = (tracks: readonly (readonly Cell[])[]): (readonly Cell[])[] => [...new Map(tracks.map((track) => [track.map(({ row, col }) => `${row},${col}`).join(" "), track])).values()];

/** Many ways at once must not hide the ground, nor the one that was chosen. */
const FAINT = 0.9;
const FAINT_CASING = 0.3;
const CASING = 0.85;
const REACH = "#1a1c1f";

/** The next leg on top of those that follow. */
const legs = (moment: Moment): Way[] => {
  const all = moment.act.name === "pursue" ? moment.legs.map((leg) => leg.cells) : [moment.act.route];
  const [first, ...later] = all.filter((cells) => cells.length > 1);
  return [...(later.length > 0 ? [way("plan", later, OKABE.orange, 1.8)] : []), ...(first ? [way("next leg", [first], OKABE.vermilion, 2.8)] : [])];
};

/** A way ends at a pose, from where the goal is looked at or worked on: this joins the two. */
const reaches = (moment: Moment): Way[] => {
  const targets = new Map(moment.verdicts.map(({ goal }) => [goal.id, goal.target]));
  const lines = moment.legs.flatMap(({ goal, pose }) => {
    const target = targets.get(goal);
    return target && (target.row !== pose.row || target.col !== pose.col) ? [[pose, target]] : [];
  });
  return lines.length > 0 ? [way("pose to goal", lines, REACH, 1.2, [2, 2])] : [];
};

/** The way of a member of the family: whole if it is known, else straight from pose to pose. */
const wayOf = (moment: Moment, family: Marked["family"], option: number): { cells: readonly Cell[]; whole: boolean } => {
  const whole = family?.[option];
  return whole ? { cells: whole, whole: true } : { cells: [moment.pose, ...(moment.family[option]?.poses ?? [])], whole: false };
};

const alternatives = ({ alternatives: wanted, family }: Marked, moment: Moment): Way[] =>
  wanted
    ? moment.family.flatMap((_, option) => {
        if (option === moment.chosen) return [];
        const { cells, whole } = wayOf(moment, family, option);
        return [way("alternative", [cells], OKABE.pink, 1.5, whole ? [] : [5, 4], FAINT)];
      })
    : [];

const picked = ({ option, family }: Marked, moment: Moment): Shape[] => {
  if (option === undefined || option === moment.chosen || !moment.family[option]) return [];
  const { cells, whole } = wayOf(moment, family, option);
  const poses = moment.family[option]?.poses ?? [];
  return [way("picked alternative", [cells], OKABE.pink, 2.8, whole ? [] : [7, 5]), ...poses.map((cell): Dot => ({ kind: "dot", cell, colour: OKABE.pink }))];
};

const WEIGHT: Record<GoalState, number> = { dropped: 0, deferred: 1, done: 2, planned: 3, next: 4 };

const marks = ({ run, index, goal }: Marked, moment: Moment): Mark[] => {
  const turns = sequence(moment);
  const known = [...run.verdictsUpTo(index).values()].map(({ verdict, index: said }): Mark => {
    // A goal of which nothing more is said has ended; what was last said of it stands.
    const state = stateOf(verdict, run.moment(said) ?? moment);
    const turn = said === index ? turns.indexOf(verdict.goal.id) : -1;
    return { kind: "mark", goal: verdict.goal.id, cell: verdict.goal.target, state, turn: turn < 0 ? undefined : turn, picked: verdict.goal.id === goal };
  });
  known.sort((a, b) => Number(a.picked) - Number(b.picked) || WEIGHT[a.state] - WEIGHT[b.state] || (b.turn ?? 0) - (a.turn ?? 0));
  // Of marks that look alike and lie on one another only the last is seen; in a long run that is thousands.
  return [...new Map(known.map((mark) => [`${mark.cell.row}/${mark.cell.col}/${mark.state}/${mark.turn}/${mark.picked}`, mark])).values()];
};
