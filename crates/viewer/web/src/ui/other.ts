// The second run beside the first: one cursor, both decisions, and where they part.

import { aligned, choseAlike, firstDivergence } from "../model/compare";
import type { Run } from "../model/run";
import type { Moment } from "../model/types";
import { h } from "./dom";
import { chance, clock, energy, goalName, place, plain, share, trigger } from "./format";

export interface OtherHandlers {
  /** Both runs to their decisions of this place: where runs part is told by number, not by time. */
  part(index: number): void;
  close(): void;
}

const FACTS = ["mission", "rule", "policy", "prize", "statistic", "paradox", "seed", "overrides", "version", "decision_version"];

/** The page about the second run. */
export const otherPage = (a: Run, b: Run, one: Moment, other: Moment, handlers: OtherHandlers): HTMLElement[] => {
  const { grid, identityRadiusM } = a.facts;
  const differ = FACTS.filter((key) => (a.facts.run[key] ?? "") !== (b.facts.run[key] ?? ""));
  const first = firstDivergence(a, b);
  const sameGround = grid.rows === b.facts.grid.rows && grid.cols === b.facts.grid.cols && grid.spacingM === b.facts.grid.spacingM;
  const [chosenA, chosenB] = [one.family[one.chosen], other.family[other.chosen]];
  const row = (label: string, left: string, right: string): HTMLElement =>
    h("tr", { class: left === right ? "" : "differs" }, h("th", {}, label), h("td", {}, left), h("td", {}, right));
  const pairs = aligned(one, other, grid, identityRadiusM);
  return [
    h("p", { class: "note" }, differ.length === 0 ? "The two runs are of one mission, rule, policy and seed." : `They differ in ${differ.join(", ")}.`, sameGround ? "" : " Their grids differ: places cannot be compared."),
    h(
      "p",
      { class: "tools" },
      h("b", {}, choseAlike(one, other, grid, identityRadiusM) ? "Chosen alike." : "Chosen otherwise."),
      first === undefined
        ? h("span", {}, "The runs choose alike throughout.")
        : h("button", { type: "button", onclick: () => handlers.part(first) }, `First divergence: decision ${a.moment(first)?.number ?? first}`),
      h("button", { type: "button", onclick: handlers.close }, "Close B"),
    ),
    h(
      "table",
      { class: "sides" },
      h("thead", {}, h("tr", {}, h("th", {}), h("th", {}, `A: ${a.facts.name}`), h("th", {}, `B: ${b.facts.name}`))),
      h(
        "tbody",
        {},
        ...differ.map((key) => row(key.replaceAll("_", " "), a.facts.run[key] || "none", b.facts.run[key] || "none")),
        row("decision", `${one.number} at ${clock(one.timeS)}`, `${other.number} at ${clock(other.timeS)}`),
        row("because", one.triggers.map(trigger).join("; "), other.triggers.map(trigger).join("; ")),
        row("rover", place(one.pose), place(other.pose)),
        row("act", actOf(one), actOf(other)),
        row("value", chosenA ? plain(chosenA.value) : "none", chosenB ? plain(chosenB.value) : "none"),
        row("reliability", chosenA ? chance(chosenA.reliability) : "none", chosenB ? chance(chosenB.reliability) : "none"),
        row("energy", chosenA ? energy(chosenA.energyJ) : "none", chosenB ? energy(chosenB.energyJ) : "none"),
      ),
    ),
    h("h3", {}, "Sequences, aligned by place"),
    h(
      "table",
      { class: "sides" },
      h(
        "tbody",
        {},
        pairs.map(({ a: left, b: right }) => {
          const goal = left ?? right;
          return h(
            "tr",
            { class: left && right ? "" : "differs" },
            h("th", {}, goal?.directive ?? ""),
            h("td", {}, left ? `${goalName(left.id)} ${place(left.target)}, prize ${share(left.prize)}` : "·"),
            h("td", {}, right ? `${goalName(right.id)} ${place(right.target)}, prize ${share(right.prize)}` : "·"),
          );
        }),
      ),
    ),
    h("p", { class: "sub" }, `Goals of one directive within ${identityRadiusM} m are one place; their names are each run's own.`),
  ];
};

const actOf = ({ act }: Moment): string => (act.goal === undefined ? act.name : `${act.name} ${goalName(act.goal)}`);
