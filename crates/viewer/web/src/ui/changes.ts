// What a decision changed: goals that entered, left, moved, changed in themselves, were found or ended.

import type { ChangeKind, GoalChange } from "../model/changes";
import type { Run } from "../model/run";
import type { Moment } from "../model/types";
import { h } from "./dom";
import { csvButton, fileName } from "./export";
import { fromTo, goalName, place, reason, share, termOf } from "./format";
import { changeSaying, saying } from "./sayings";
import { changesTable } from "./tables";

const WORDS: Record<ChangeKind, string> = {
  done: "Done",
  dropped: "Dropped",
  entered: "Entered the plan",
  left: "Left the plan",
  moved: "Moved in the plan",
  altered: "Changed in itself",
  found: "Newly found, not in the plan",
};

export const changesPage = (run: Run, moment: Moment, changed: readonly GoalChange[], before: Moment | undefined, pick: (goal: number) => void): HTMLElement[] => {
  const kinds = [...new Set(changed.map((change) => change.kind))];
  return [
    h(
      "p",
      { class: "tools" },
      h("span", { class: "note" }, before ? (changed.length === 0 ? "Nothing changed about any goal." : `Against decision ${before.number}.`) : "The first decision: everything is new."),
      csvButton("the changes", () => fileName(run, moment, "changes", "csv"), () => changesTable(moment, changed)),
    ),
    ...kinds.flatMap((kind) => {
      const these = changed.filter((change) => change.kind === kind);
      return [h("h3", {}, `${WORDS[kind]} `, h("span", { class: "count" }, these.length)), h("ul", { class: "changes" }, these.map((change) => line(change, moment, pick)))];
    }),
  ];
};

const line = (change: GoalChange, moment: Moment, pick: (goal: number) => void): HTMLElement => {
  const { goal } = change.verdict;
  const turn = (at: number | undefined): string => (at === undefined ? "" : `${at + 1}.`);
  const bits = [
    change.kind === "entered" ? `turn ${turn(change.to)}` : "",
    change.kind === "left" ? `was ${turn(change.from)}` : "",
    change.kind === "moved" ? `${turn(change.from)} → ${turn(change.to)}` : "",
    change.targetWas ? `target ${place(change.targetWas)} → ${place(goal.target)}` : "",
    change.prizeWas === undefined ? "" : `prize ${fromTo(change.prizeWas, goal.prize, share)}`,
    ...change.verdict.changes.map((one) => [one.transformation, one.reason, one.terms.map((of) => termOf(one.reason, of)).join(", ")].filter(Boolean).join(" ")),
    // Said already, if the goal itself changed for it.
    change.kind === "altered" || change.verdict.changes.some((one) => one.reason === change.verdict.reason) ? "" : reason(change.verdict),
  ].filter(Boolean);
  const own = change.verdict.changes.map((one) => changeSaying(one.transformation, one.reason));
  const told = [...new Set([...own, saying(change.verdict, moment)])].filter(Boolean).join(" ");
  return h(
    "li",
    { title: told },
    h("button", { type: "button", class: "goal-link", onclick: () => pick(goal.id) }, goalName(goal.id)),
    h("span", { class: "sub" }, goal.directive),
    h("span", {}, bits.join(" · "), h("span", { class: "saying" }, told)),
  );
};
