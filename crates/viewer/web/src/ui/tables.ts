// Tables as they are saved: numbers as the log has them, turns from 1 as on the page, units in the heads.

import type { GoalChange } from "../model/changes";
import { bestFound } from "../model/choice";
import type { Run } from "../model/run";
import { reliability, stateOf } from "../model/states";
import type { Moment } from "../model/types";
import type { Table } from "./export";
import { goalName, reason, termOf, trigger } from "./format";

/** The log counts turns from 0. */
const turn = (at: number | undefined): number | undefined => (at === undefined ? undefined : at + 1);

export const goalsTable = (moment: Moment): Table => [
  ["decision", "time_s", "goal", "directive", "state", "turn", "row", "col", "interest", "prize", "prominence", "ignorance", "paradox", "contradiction", "reliability_so_far", "action", "reason", "terms"],
  ...moment.verdicts.map((verdict) => {
    const { goal } = verdict;
    return [
      moment.number, moment.timeS, goalName(goal.id), goal.directive, stateOf(verdict, moment), turn(verdict.turn), goal.target.row, goal.target.col,
      goal.interest, goal.prize, goal.prominence, goal.ignorance, goal.paradox, goal.contradiction, reliability(verdict, moment), verdict.action, verdict.reason,
      verdict.terms.map((one) => termOf(verdict.reason, one)).join("; "),
    ];
  }),
];

export const changesTable = (moment: Moment, changed: readonly GoalChange[]): Table => [
  ["decision", "goal", "directive", "change", "turn_before", "turn_now", "target_row_before", "target_col_before", "target_row", "target_col", "prize_before", "prize", "action", "reason", "transformations"],
  ...changed.map(({ kind, verdict, from, to, targetWas, prizeWas }) => [
    moment.number, goalName(verdict.goal.id), verdict.goal.directive, kind, turn(from), turn(to),
    targetWas?.row, targetWas?.col, verdict.goal.target.row, verdict.goal.target.col, prizeWas, verdict.goal.prize, verdict.action, reason(verdict),
    verdict.changes.map((one) => [one.transformation, one.reason, one.terms.map((of) => termOf(one.reason, of)).join(", ")].filter(Boolean).join(" ")).join("; "),
  ]),
];

export const plansTable = (moment: Moment): Table => {
  const objectives = [...new Set(moment.family.flatMap((one) => one.objectives.map(({ name }) => name)))];
  return [
    ["decision", "plan", "chosen", "best_found", "order", "value", "prize", "expected_interest", "reliability", "time_s", "energy_j", "data_mb", "way_m", ...objectives.map((name) => `objective_${name}`)],
    ...moment.family.map((one, i) => [
      moment.number, i, i === moment.chosen ? "yes" : "no", i === (bestFound(moment) ?? moment.chosen) ? "yes" : "no", one.order.map(goalName).join(" "), one.value, one.prize, one.expected, one.reliability, one.timeS, one.energyJ, one.dataMb, one.lengthM,
      ...objectives.map((name) => one.objectives.find((objective) => objective.name === name)?.value),
    ]),
  ];
};

/** The whole run, a decision a row. */
export const decisionsTable = (run: Run): Table => [
  ["decision", "time_s", "triggers", "row", "col", "energy_spent_j", "data_mb", "driven_m", "seen", "background", "goals", "act", "act_goal", "sequence", "value", "prize", "expected_interest", "reliability", "plan_time_s", "plan_energy_j", "result"],
  ...run.moments.map((moment) => {
    const one = moment.family[moment.chosen];
    const { act, spent } = moment;
    return [
      moment.number, moment.timeS, moment.triggers.map(trigger).join("; "), moment.pose.row, moment.pose.col, spent.energyJ, spent.dataMb, spent.lengthM, moment.seen, moment.background, moment.verdicts.length,
      act.name, act.goal === undefined ? undefined : goalName(act.goal), one?.order.map(goalName).join(" "), one?.value, one?.prize, one?.expected, one?.reliability, one?.timeS, one?.energyJ,
      run.outcomes.get(moment.number)?.result,
    ];
  }),
];

export const writtenTable = (run: Run): Table => [
  ["decision", "time_s", "level", "text"],
  ...run.lines.map((line) => [line.decision, line.timeS, line.level, line.text]),
  ...run.happenings.map((one) => [one.decision, one.timeS, one.kind, one.text]),
];

export const topicsTable = (run: Run): Table => [
  ["topic", "schema", "messages", "bytes", "shown", "not_decoded", "why"],
  ...run.topics.map((one) => [one.topic, one.schema, one.count, one.bytes, one.known ? "yes" : "no", one.unread, one.why]),
];

export const factsTable = (run: Run): Table => [["key", "value"], ...Object.entries({ ...run.facts.run, ...run.end })];
