// The head of the decision panel: why it was due, what is to be done, what came of it, and the sequence chosen.

import type { Run } from "../model/run";
import { stateOf } from "../model/states";
import type { Moment } from "../model/types";
import { markIcon } from "../view/marks";
import { firstWords, heldLine } from "./choice";
import { h } from "./dom";
import { chance, clock, energy, goalName, metres, place, plain, trigger } from "./format";

export interface HeadHandlers {
  step(by: number): void;
  pick(goal: number | undefined): void;
}

export const decisionHead = (run: Run, moment: Moment, picked: number | undefined, handlers: HeadHandlers): HTMLElement[] => {
  const chosen = moment.family[moment.chosen];
  return [
    h(
      "div",
      { class: "title" },
      h("button", { type: "button", class: "step", title: "Decision before (←)", "aria-label": "Decision before", onclick: () => handlers.step(-1) }, "‹"),
      h("h2", {}, `Decision ${moment.number}`, h("small", { class: "of" }, ofWords(run))),
      h("button", { type: "button", class: "step", title: "Next decision (→)", "aria-label": "Next decision", onclick: () => handlers.step(1) }, "›"),
      h("p", { class: "where" }, `${clock(moment.timeS)} · ${metres(moment.spent.lengthM)} driven · rover at ${place(moment.pose)}`),
    ),
    story(run, moment),
    sequence(moment, picked, handlers),
    chosen && chosen.order.length > 0
      ? h(
          "div",
          { class: "numbers" },
          figure("value", plain(chosen.value, 1)),
          figure("reliability", chance(chosen.reliability)),
          figure("time", clock(chosen.timeS)),
          figure("energy", energy(chosen.energyJ)),
          figure("data", `${chosen.dataMb.toFixed(0)} MB`),
          figure("way", metres(chosen.lengthM)),
        )
      : h("p", { class: "note" }, "No sequence of goals was chosen."),
  ];
};

/** The numbers that a run's decisions have: the last of them is the last decision. */
export const ofWords = ({ moments }: Run): string => ` of ${moments[0]?.number ?? 0} … ${moments.at(-1)?.number ?? 0}`;

const story = (run: Run, moment: Moment): HTMLElement => {
  const outcome = run.outcomes.get(moment.number);
  const { act } = moment;
  const drive = act.name === "pursue" && act.lengthM === 0 ? ", from where it stands" : act.lengthM > 0 ? `, ${metres(act.lengthM)} in ${clock(act.timeS)}, reliability ${chance(act.reliability)}` : "";
  const what = act.name === "pursue" && act.goal !== undefined ? `pursue ${goalName(act.goal)}` : act.name;
  const wake = act.wake ? `, until ${act.wake}` : "";
  const [held, first] = [heldLine(moment, run.facts.hysteresis), firstWords(moment)];
  return h(
    "dl",
    { class: "story" },
    h("dt", {}, "because"),
    h("dd", {}, moment.triggers.map((one) => h("span", { class: "trigger" }, trigger(one)))),
    h("dt", {}, "so"),
    h("dd", {}, h("b", {}, what), drive, wake),
    ...(held ? [h("dt", {}, "held"), h("dd", { class: "held" }, held)] : []),
    ...(first && act.name === "pursue" ? [h("dt", {}, "first"), h("dd", { class: "first" }, first)] : []),
    ...(outcome
      ? [
          h("dt", {}, "came of it"),
          h("dd", {}, h("b", {}, outcome.result), outcome.goal === undefined ? "" : ` ${goalName(outcome.goal)}`, ` at ${clock(outcome.spent.timeS)}`, outcome.track.length > 1 ? `, ${cells(outcome.track.length - 1)} driven` : "", outcome.operators.length > 0 ? `; ${outcome.operators.join(", ")}` : ""),
        ]
      : []),
  );
};

/** The chosen order, as buttons. */
const sequence = (moment: Moment, picked: number | undefined, handlers: HeadHandlers): HTMLElement =>
  h(
    "ol",
    { class: "sequence", "aria-label": "Chosen sequence" },
    moment.legs.map((leg) => {
      const verdict = moment.verdicts.find((one) => one.goal.id === leg.goal);
      return h(
        "li",
        {},
        h(
          "button",
          {
            type: "button",
            class: leg.goal === picked ? "picked" : "",
            title: `${verdict?.goal.directive ?? ""}: ${leg.operators.join(", ")}; ${metres(leg.lengthM)}, reliability ${chance(leg.reliability)}`,
            onclick: () => handlers.pick(leg.goal === picked ? undefined : leg.goal),
          },
          verdict ? markIcon(stateOf(verdict, moment)) : "",
          goalName(leg.goal),
        ),
      );
    }),
  );

const cells = (count: number): string => `${count} cell${count === 1 ? "" : "s"}`;

const figure = (label: string, value: string): HTMLElement => h("div", {}, h("span", { class: "value" }, value), h("span", { class: "label" }, label));
