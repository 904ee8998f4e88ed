// What the log's codes for actions, reasons and changes mean, a sentence each.

import type { Moment, Verdict } from "../model/types";
import { goalName } from "./format";

export const ACTIONS: Readonly<Record<string, string>> = {
  add: "It enters the plan.",
  keep: "It stays in the plan, at its place among the others.",
  modify: "It stays in the plan, but something about the goal itself changed.",
  reorder: "It stays in the plan, at another turn.",
  defer: "It is known and open, but left out of this plan.",
  drop: "It is given up.",
  achieve: "It is done.",
};

export const REASONS: Readonly<Record<string, string>> = {
  unchanged: "Nothing speaks against it, and the best plan has it where it was.",
  "peak-moved": "New readings moved the maximum to another cell of its region: the target follows. Compared are the prizes of the map at both cells, before the directive's weight.",
  refined: "What was found there fits a heavier directive.",
  generalised: "Nothing reaches the target: another place of its kind stands in for it.",
  abstracted: "The class of its object became unclear: a broader directive holds.",
  concretised: "The class of its object became clear: a narrower directive holds.",
  eroded: "It is pursued under a weaker directive after a failed try.",
  afforded: "What is left cannot pay for the stronger directive: a weaker one fits.",
  fault: "Nothing aboard can bring about any more what it wanted: a weaker directive holds.",
  retyped: "Its maximum is gone, and one of another kind stands there.",
  "pose-lost": "The pose it was to be served from cannot be reached any more: another one serves.",
  "lost-interest": "What is known now makes the place worth too little.",
  "no-maximum": "The map has no maximum there any more.",
  settled: "The readings are so much surer than when it was found that its contradiction counts as seen.",
  unreachable: "No pose that serves it can be reached.",
  "attempts-spent": "It failed as often as it may.",
  merged: "Its maximum is that of another goal: the two become one. Compared are the prizes of the map at both cells, before the directive's weight.",
  explained: "Another goal already accounts for its maximum. Compared are the prizes of the map at both cells, before the directive's weight.",
  "off-map": "It lies outside the ground that the rover works on.",
  window: "It cannot be reached within its window of time.",
  withdrawn: "The ground took its command back.",
  done: "Its operators were carried out.",
  "new-maximum": "The map has a maximum there that no goal stood for.",
  split: "Its maximum broke off from that of another goal.",
  commanded: "The ground asks for it.",
  "new-evidence": "The place was done, but an expert speaks of it now that had said nothing then.",
  reopened: "The place was given up, but its ground has changed.",
  "better-order": "The best plan has it at another turn.",
  promoted: "It was known before, and is worth a place in the plan now.",
  outweighed: "There is room for it, but the best plan with it is worth no more than the one without.",
  superseded: "It was in the plan, and a goal that came in is worth more.",
  time: "A plan with it would take more time than is left.",
  energy: "A plan with it would take more energy than is left.",
  data: "A plan with it would take more data volume than is left.",
  risk: "A plan with it would be less reliable than the floor allows.",
  preconditions: "Nothing brings about what it needs: facts, order or the leg under way rule it out.",
  excluded: "It lies so near a goal of the plan that one stands for both.",
  held: "A plan with it is better than the committed one, but gains less than a change must.",
  "beyond-exact": "The search takes so many goals; the most this one could add is less than the least of those taken.",
  "search-cut": "The search ended at its limit of effort without meeting a plan with it.",
};

export const TRANSFORMATIONS: Readonly<Record<string, string>> = {
  identity: "The goal is what it was.",
  specialization: "The goal became narrower: another cell of its region, or a heavier directive.",
  generalization: "The goal became wider: another place of its kind stands in for it.",
  abstraction: "A broader directive holds.",
  concretion: "A narrower directive holds.",
  erosion: "A weaker directive holds.",
  retyping: "It is a goal of another kind now.",
  substitution: "Another pose serves it.",
  retraction: "The goal ends: given up, or done.",
  formulation: "The goal is new.",
  reorder: "The goal has another turn in the plan.",
};

/** Who excluded whom, and why the smaller prize may stand. */
const exclusion = ({ goal, other, terms }: Verdict, { held }: Moment): string => {
  const by = other === undefined ? "a goal of the plan" : goalName(other);
  const near = `${goalName(goal.id)} lies so near ${by} that one stands for both (the directive's exclusion radius), and the plan holds ${by}.`;
  const smaller = terms.some(({ name, value, limit }) => name === "prize" && value !== undefined && limit !== undefined && value > limit);
  if (!smaller) return near;
  const why = held
    ? "the committed plan was held, because a better one gains less than a change must."
    : "plans are weighed whole, with ways, risk and limits, not goal by goal.";
  return `${near} The prize of ${by} is the smaller, and it stays all the same: ${why}`;
};

/** What a verdict means; empty for codes that are not known here. */
export const saying = (verdict: Verdict, moment: Moment): string => {
  const why = verdict.reason === "excluded" ? exclusion(verdict, moment) : REASONS[verdict.reason];
  return [ACTIONS[verdict.action], why].filter(Boolean).join(" ");
};

/** What a change of the goal itself means. */
export const changeSaying = (transformation: string, reason: string): string => [TRANSFORMATIONS[transformation], REASONS[reason]].filter(Boolean).join(" ");
