// The timeline as a drawing: decisions and events of one run or two, and a lane for the life of each goal.
//
// States differ in shape besides colour: a full bar is pursued next, an open one is in the plan, a dotted line is
// deferred; a square is done, a cross dropped.

import type { Life } from "../model/lives";
import { paired } from "../model/pairs";
import { sameGround } from "../model/compare";
import type { Pair } from "../model/pairs";
import type { Run } from "../model/run";
import { STATES, stateLabel } from "../model/states";
import type { GoalState } from "../model/states";
import { goalName } from "../ui/format";
import type { Axis } from "../state";
import { OKABE } from "./colour";
import type { Ink } from "./ink";
import { markPath, stateColour } from "./marks";
import { TimeScale } from "./timescale";

export interface TimelineScene {
  run: Run;
  index: number;
  axis: Axis;
  /** The goal picked out, by its name in the run that leads. */
  goal: number | undefined;
  lead: "a" | "b";
  /** A second run under the same cursor. */
  other?: { run: Run; index: number };
}

/** A goal's life in each run. */
export type Lane = Pair<Life>;

export interface Colours {
  ink: string;
  faint: string;
  rule: string;
  scroll: string;
  panel: string;
  picked: string;
  accent: string;
}

export const LEFT = 88;
export const RIGHT = 118;
/** Room of a label of the axis. */
const LABEL_PX = 30;
const AXIS_Y = 15;
const ROW = 18;
/** Where the key begins, below the buttons. */
const KEY_Y = 90;
const KEY_ROW = 14;
/** What the words at the end of a log that breaks off take of the axis. */
const BREAK_PX = 84;
/** Dots and stretches nearer than this to the last one are not drawn again. */
const NEAR_PX = 0.7;

const RESULTS: Record<string, { colour: string; shape: "square" | "ring" | "cross" }> = {
  achieved: { colour: OKABE.green, shape: "square" },
  arrived: { colour: OKABE.green, shape: "ring" },
  stopped: { colour: OKABE.grey, shape: "ring" },
  interrupted: { colour: OKABE.sky, shape: "ring" },
  blocked: { colour: OKABE.vermilion, shape: "cross" },
  aborted: { colour: OKABE.vermilion, shape: "cross" },
};

/** Heights of things, which depend on whether there is a second run. */
export interface Rows {
  decisions: readonly number[];
  events: readonly number[];
  lanes: number;
  lane: number;
}

export const rowsOf = (scene: TimelineScene): Rows =>
  scene.other
    ? { decisions: [33, 33 + 2 * ROW], events: [33 + ROW, 33 + 3 * ROW], lanes: 33 + 4 * ROW - 3, lane: 17 }
    : { decisions: [33], events: [33 + ROW], lanes: 33 + 2 * ROW - 3, lane: 10 };

/** Goals of one place in one lane; without the same ground no two are. */
export const lanesOf = ({ run, other }: TimelineScene): readonly Lane[] => {
  if (!other) return run.lives.lanes.map((a) => ({ a }));
  const { grid, identityRadiusM } = run.facts;
  if (!sameGround(grid, other.run.facts.grid)) return [...run.lives.lanes.map((a) => ({ a })), ...other.run.lives.lanes.map((b) => ({ b }))];
  return paired(run.lives.lanes, other.run.lives.lanes, grid, identityRadiusM);
};

export const scaleOf = ({ run, axis, other }: TimelineScene, width: number): TimeScale =>
  new TimeScale(other ? [run, other.run] : [run], axis, LEFT, Math.max(10, width - LEFT - RIGHT));

export const laneName = ({ a, b }: Lane, two: boolean): string =>
  two ? [a && `A ${goalName(a.goal)}`, b && `B ${goalName(b.goal)}`].filter(Boolean).join(" · ") : a ? goalName(a.goal) : "";

/** Draws it all; `scrolled` is how far the lanes are. */
export const drawTimeline = (ink: Ink, scene: TimelineScene, lanes: readonly Lane[], size: { width: number; height: number }, scrolled: number, colours: Colours): void => {
  const { width, height } = size;
  const scale = scaleOf(scene, width);
  const rows = rowsOf(scene);
  const label = (words: string, y: number): void => ink.text(words, 10, y, { size: 11, fill: colours.faint, anchor: "start" });
  ink.within(0, rows.lanes - 4, width, height - rows.lanes + 4, () => {
    drawLanes(ink, scene, lanes, scale, { ...size, scrolled }, colours);
  });
  const ends = scale.x(scene.run, scene.run.moments.length);
  for (const { x, words } of scale.ticks()) {
    ink.line(Math.round(x) + 0.5, AXIS_Y + 8, Math.round(x) + 0.5, height, { stroke: colours.rule });
    const told = broken(scene.run) && Math.abs(x - ends + BREAK_PX / 2) < BREAK_PX / 2 + 14;
    // The last one keeps clear of what stands on the right.
    if (!told) ink.text(words, x, AXIS_Y, { size: 11, fill: colours.faint, anchor: x > width - RIGHT - LABEL_PX / 2 ? "end" : "middle" });
  }
  label(scene.axis === "time" ? "time, h" : "number", AXIS_Y);
  const runs = [{ run: scene.run, index: scene.index }, ...(scene.other ? [scene.other] : [])];
  runs.forEach(({ run, index }, side) => {
    const name = scene.other ? ` ${side === 0 ? "A" : "B"}` : "";
    const [decisionsY, eventsY] = [rows.decisions[side] ?? 0, rows.events[side] ?? 0];
    label(`decisions${name}`, decisionsY);
    label(`events${name}`, eventsY);
    drawDecisions(ink, run, index, scale, decisionsY, colours);
    drawEvents(ink, run, scale, eventsY);
  });
  runs.forEach(({ run }, side) => drawBreak(ink, run, scene.other ? ` ${side === 0 ? "A" : "B"}` : "", scale, [(rows.decisions[side] ?? 0) - 9, (rows.events[side] ?? 0) + 7], colours));
  drawCursor(ink, scene, scale, rows, height, colours);
  drawKey(ink, width - RIGHT + 22, height, colours);
};

const drawDecisions = (ink: Ink, run: Run, at: number, scale: TimeScale, y: number, { ink: dark, faint, panel }: Colours): void => {
  let last = Number.NEGATIVE_INFINITY;
  run.moments.forEach((moment, index) => {
    const x = scale.x(run, index);
    if (x - last < NEAR_PX) return;
    last = x;
    const waits = moment.act.name === "wait";
    const paint = { fill: waits ? panel : index <= at ? dark : faint, stroke: waits ? dark : panel, width: 1.4 };
    if (moment.act.name === "pursue") ink.circle(x, y, 4, paint);
    else ink.rect(x - 3.5, y - 3.5, 7, 7, paint);
  });
};

const drawEvents = (ink: Ink, run: Run, scale: TimeScale, y: number): void => {
  let last = Number.NEGATIVE_INFINITY;
  for (const outcome of run.outcomes.values()) {
    const look = RESULTS[outcome.result] ?? { colour: OKABE.grey, shape: "ring" as const };
    const x = scale.xOf(run, outcome.spent.timeS);
    if (x - last < NEAR_PX && look.shape !== "cross") continue;
    last = x;
    if (look.shape === "square") ink.rect(x - 3.6, y - 3.6, 7.2, 7.2, { fill: look.colour });
    else if (look.shape === "ring") ink.circle(x, y, 3, { stroke: look.colour, width: 1.8 });
    else ink.path(markPath("dropped", 5), x, y, { stroke: look.colour, width: 1.8 });
  }
  for (const { timeS, kind } of run.happenings) {
    ink.path("M0 -5L5 4L-5 4Z", scale.xOf(run, timeS), y, { fill: kind === "fault" ? OKABE.vermilion : OKABE.pink });
  }
};

const drawLanes = (ink: Ink, scene: TimelineScene, lanes: readonly Lane[], scale: TimeScale, size: { width: number; height: number; scrolled: number }, colours: Colours): void => {
  const rows = rowsOf(scene);
  const { width, height, scrolled } = size;
  lanes.forEach((lane, i) => {
    const y = rows.lanes + i * rows.lane - scrolled + rows.lane / 2;
    if (y < rows.lanes - rows.lane || y > height + rows.lane) return;
    const picked = scene.goal !== undefined && lane[scene.lead]?.goal === scene.goal;
    if (picked) ink.rect(0, y - rows.lane / 2, width, rows.lane, { fill: colours.picked });
    ink.text(laneName(lane, scene.other !== undefined), LEFT - 12, y + 0.5, { size: 9.5, fill: picked ? colours.ink : colours.faint, anchor: "end", bold: picked });
    if (!scene.other) {
      if (lane.a) drawLife(ink, scene.run, lane.a, scale, y, 1, colours);
      return;
    }
    if (lane.a) drawLife(ink, scene.run, lane.a, scale, y - 3.6, 0.78, colours);
    if (lane.b) drawLife(ink, scene.other.run, lane.b, scale, y + 3.8, 0.78, colours);
    ink.line(LEFT - 8, y + rows.lane / 2, width - RIGHT, y + rows.lane / 2, { stroke: colours.rule, width: 0.6 });
  });
  const all = lanes.length * rows.lane;
  const room = height - rows.lanes;
  if (all > room) ink.rect(width - RIGHT + 8, rows.lanes + (scrolled / all) * room, 7, (room / all) * room, { fill: colours.scroll });
};

const broken = ({ wholeness: { kind } }: Run): boolean => kind === "cut" || kind === "damaged";

/** A file that breaks off ends the axis, not the mission. */
const drawBreak = (ink: Ink, run: Run, name: string, scale: TimeScale, [from, to]: readonly [number, number], colours: Colours): void => {
  const { kind } = run.wholeness;
  if (!broken(run)) return;
  const x = scale.x(run, run.moments.length);
  ink.line(x, from, x, to, { stroke: OKABE.vermilion, width: 2, dash: [4, 2] });
  // Beside the hours, which make room: dots of decisions are not to be hidden. A second run has no hours of its own.
  ink.text(`log${name} ${kind === "cut" ? "cut" : "damaged"} here`, x, from + 9 - ROW, { size: 10.5, fill: colours.ink, anchor: "end", bold: true });
};

/** One goal's life in one run, around a line. */
const drawLife = (ink: Ink, run: Run, life: Life, scale: TimeScale, y: number, fat: number, colours: Colours): void => {
  let last = Number.NEGATIVE_INFINITY;
  for (const { state, from, to } of life.stretches) {
    const [x0, x1] = [scale.x(run, from), scale.x(run, to)];
    if (x1 - last < NEAR_PX) continue;
    last = x1;
    drawStretch(ink, state, x0, Math.max(1.5, x1 - x0), y, fat);
  }
  if (life.end) drawEnd(ink, life.end.state, scale.x(run, life.end.at), y, fat, colours);
};

const drawStretch = (ink: Ink, state: GoalState, x: number, width: number, y: number, fat: number): void => {
  const colour = stateColour[state];
  if (state === "next") ink.rect(x, y - 3.5 * fat, width, 7 * fat, { fill: colour });
  else if (state === "planned") ink.rect(x + 0.5, y - 2.4 * fat, Math.max(0.8, width - 1), 4.8 * fat, { fill: colour, alpha: 0.25, stroke: colour, width: 1.2 });
  else ink.line(x, y, x + width, y, { stroke: colour, width: 1.8 * fat, dash: [2.5, 2] });
};

const drawEnd = (ink: Ink, state: GoalState, x: number, y: number, fat: number, colours: Colours): void => {
  if (state === "done") ink.path(markPath("done", 4.6 * fat), x, y, { fill: stateColour.done });
  else ink.path(markPath("dropped", 4.6 * fat), x, y, { stroke: colours.faint, width: 1.6 });
};

const drawCursor = (ink: Ink, scene: TimelineScene, scale: TimeScale, rows: Rows, height: number, { accent }: Colours): void => {
  const lead = scene.lead === "b" && scene.other ? scene.other : scene;
  const x = scale.x(lead.run, lead.index);
  ink.line(x, AXIS_Y + 6, x, height, { stroke: accent, width: 1.6 });
  ink.circle(scale.x(scene.run, scene.index), rows.decisions[0] ?? 0, 6.5, { stroke: accent, width: 2.4 });
  if (!scene.other) return;
  // The decision of the run that follows may lie before the cursor's time.
  ink.circle(scale.x(scene.other.run, scene.other.index), rows.decisions[1] ?? 0, 6.5, { stroke: accent, width: 2.4 });
};

/** What the shapes mean. */
const drawKey = (ink: Ink, x: number, height: number, colours: Colours): void => {
  STATES.forEach((state, i) => {
    const y = KEY_Y + i * KEY_ROW;
    if (y + 5 > height) return;
    if (state === "done" || state === "dropped") drawEnd(ink, state, x + 11, y, 1, colours);
    else drawStretch(ink, state, x, 22, y, 1);
    ink.text(stateLabel[state], x + 28, y, { size: 10, fill: colours.faint, anchor: "start" });
  });
};
