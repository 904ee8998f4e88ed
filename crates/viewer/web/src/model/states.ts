// What a goal is, in a word: the state that maps, tables and lanes show by colour and shape.

import type { Moment, Verdict } from "./types";

export type GoalState = "next" | "planned" | "deferred" | "done" | "dropped";

export const STATES: readonly GoalState[] = ["next", "planned", "deferred", "done", "dropped"];

export const stateLabel: Record<GoalState, string> = {
  next: "next",
  planned: "in the plan",
  deferred: "deferred",
  done: "done",
  dropped: "dropped",
};

export const stateOf = (verdict: Verdict, moment: Moment): GoalState => {
  if (verdict.action === "achieve") return "done";
  if (verdict.action === "drop") return "dropped";
  if (verdict.action === "defer" || verdict.turn === undefined) return "deferred";
  return moment.act.name === "pursue" && moment.act.goal === verdict.goal.id ? "next" : "planned";
};

/** The chance to get as far as a goal by the chosen plan; nothing if it is not in it. */
export const reliability = (verdict: Verdict, moment: Moment): number | undefined =>
  verdict.turn === undefined ? undefined : moment.legs.find((leg) => leg.goal === verdict.goal.id)?.reliabilitySoFar;
