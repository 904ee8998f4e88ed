// The second run beside the first: how the runs differ, where they part, and both decisions term by term.

import { aligned, choseAlike, factPairs, firstDivergence, isDigest, placeRadiusM, sameGround, turnOf } from "../model/compare";
import { sequence } from "../model/changes";
import type { Taken } from "../model/divergence";
import type { Pair } from "../model/pairs";
import type { Run } from "../model/run";
import type { Goal, GridSpec, Moment } from "../model/types";
import { h } from "./dom";
import { csvButton, fileName } from "./export";
import type { Table } from "./export";
import { clock, goalName, place, share } from "./format";
import { TermTable } from "./terms";

export interface OtherHandlers {
  /** Both runs to their decisions of this place: where runs part is told by number, not by time. */
  part(index: number): void;
  close(): void;
}

/** Found once for as much as was read: runs may be long. */
class Parting {
  private found: number | undefined;
  private of = "";

  between(a: Run, b: Run): number | undefined {
    const of = `${a.facts.name}/${a.moments.length}/${b.facts.name}/${b.moments.length}/${a.wholeness.kind}/${b.wholeness.kind}`;
    if (of !== this.of) this.found = firstDivergence(a, b);
    this.of = of;
    return this.found;
  }
}

export class OtherPage {
  private readonly terms = new TermTable();
  private readonly parting = new Parting();
  private allFacts = false;

  constructor(
    private readonly page: HTMLElement,
    private readonly handlers: OtherHandlers,
  ) {}

  /** Place of the first decision taken otherwise. */
  firstDivergence(a: Run, b: Run): number | undefined {
    return this.parting.between(a, b);
  }

  show(a: Taken, b: Taken): void {
    const { grid, identityRadiusM } = a.run.facts;
    const comparable = sameGround(grid, b.run.facts.grid);
    const first = this.firstDivergence(a.run, b.run);
    const name = (what: string): string => fileName(a.run, a.moment, `${what}-against-d${b.moment.number}`, "csv");
    const radiusM = placeRadiusM(a.run, b.run);
    const pairs = aligned(a.moment, b.moment, grid, radiusM);
    this.terms.show(a, b);
    this.page.replaceChildren(
      h(
        "p",
        { class: "tools" },
        h("b", { class: "verdict" }, verdict(a.moment, b.moment, grid, radiusM)),
        first === undefined
          ? h("span", {}, "The runs choose alike throughout.")
          : h("button", { type: "button", title: "To the first divergence (f)", onclick: () => this.handlers.part(first) }, `First divergence: decision ${a.run.moment(first)?.number ?? first}`),
        h("span", { class: "spring" }),
        h("button", { type: "button", onclick: this.handlers.close }, "Close B"),
      ),
      h("p", { class: "sub" }, `A: decision ${a.moment.number} at ${clock(a.moment.timeS)}, ${a.run.facts.name}. B: decision ${b.moment.number} at ${clock(b.moment.timeS)}, ${b.run.facts.name}.`),
      comparable ? "" : h("p", { class: "warning" }, "The runs stand on different grids: places of one are no places of the other, and goals are not paired."),
      ...this.facts(a.run, b.run),
      h("h3", { class: "with-tools" }, h("span", {}, "Sequences, aligned by place"), h("span", { class: "spring" }), csvButton("the sequences", () => name("sequences"), () => sequencesTable(a.moment, b.moment, pairs))),
      sequences(a.moment, b.moment, pairs, grid, radiusM),
      h("p", { class: "sub" }, `Goals of one directive within ${identityRadiusM} m are one place; their names are each run's own.`),
      h("h3", { class: "with-tools" }, h("span", {}, "Term by term"), h("span", { class: "spring" }), csvButton("all terms", () => name("divergence"), () => this.terms.csv())),
      this.terms.element,
    );
  }

  private facts(a: Run, b: Run): (HTMLElement | string)[] {
    const pairs = factPairs(a, b);
    // Digests differ with anything in the mission: what differs is told by the others.
    const differ = pairs.filter((one) => one.a !== one.b && !isDigest(one.key));
    const digests = pairs.filter((one) => one.a !== one.b && isDigest(one.key));
    const equal = pairs.filter((one) => one.a === one.b);
    const all = [...differ, ...digests, ...equal];
    const row = ({ key, a: left, b: right }: (typeof pairs)[number]): HTMLElement =>
      h("tr", { class: left === right ? "" : "differs" }, h("th", { scope: "row" }, key.replaceAll("_", " ")), h("td", { title: left ?? "" }, short(key, left)), h("td", { title: right ?? "" }, short(key, right)));
    const list = h("tbody", {}, (this.allFacts ? all : differ).map(row));
    const fold = h(
      "button",
      {
        type: "button",
        class: "fold",
        "aria-expanded": String(this.allFacts),
        onclick: () => {
          this.allFacts = !this.allFacts;
          list.replaceChildren(...(this.allFacts ? all : differ).map(row));
          fold.textContent = words();
          fold.setAttribute("aria-expanded", String(this.allFacts));
        },
      },
      "",
    );
    const words = (): string => `${this.allFacts ? "▾" : "▸"} ${equal.length} facts are equal${digests.length > 0 ? `; ${digests.map(({ key }) => key.replaceAll("_", " ")).join(", ")} differ${digests.length === 1 ? "s" : ""}` : ""}`;
    fold.textContent = words();
    const names = (differ.length > 0 ? differ : digests).map(({ key }) => key.replaceAll("_", " ")).join(", ");
    return [
      h("h3", { class: "with-tools" }, h("span", {}, differ.length + digests.length === 0 ? "The runs are of one mission, rule, policy and seed" : `The runs differ in ${names}`), h("span", { class: "spring" }), csvButton("the runs' facts", () => fileName(a, undefined, "facts-a-b", "csv"), () => [["key", "a", "b", "differs"], ...pairs.map((one) => [one.key, one.a ?? "", one.b ?? "", one.a === one.b ? "no" : "yes"])])),
      h("table", { class: "sides" }, h("thead", {}, h("tr", {}, h("th", {}), h("th", { scope: "col" }, "A"), h("th", { scope: "col" }, "B"))), list),
      h("p", {}, fold),
    ];
  }
}

/** Digits of a digest that tell it from any other. */
const DIGEST_DIGITS = 12;

/** Older files do not tell all that newer ones do, which is another thing than to say that there is none. */
const short = (key: string, value: string | undefined): string => (value === undefined ? "not told" : value === "" ? "none" : isDigest(key) && value.length > DIGEST_DIGITS ? `${value.slice(0, DIGEST_DIGITS)}…` : value);

const verdict = (a: Moment, b: Moment, grid: GridSpec, radiusM: number): string => {
  const alike = choseAlike(a, b, grid, radiusM);
  const none = sequence(a).length === 0 && sequence(b).length === 0;
  if (none) return alike ? `Neither chose a goal: both ${a.act.name}.` : `Neither chose a goal: A ${a.act.name}, B ${b.act.name}.`;
  return alike ? "Chosen alike." : "Chosen otherwise.";
};

/** Both sequences; a goal that the other run has at another turn is told by that turn. */
const sequences = (a: Moment, b: Moment, pairs: readonly Pair<Goal>[], grid: GridSpec, radiusM: number): HTMLElement => {
  const side = (goal: Goal | undefined, own: Moment, partner: Goal | undefined, name: string): HTMLElement => {
    if (goal) return h("td", {}, `${sequence(own).indexOf(goal.id) + 1}. ${goalName(goal.id)} ${place(goal.target)}, prize ${share(goal.prize)}`);
    const turn = partner && turnOf(partner, own, grid, radiusM);
    return h("td", { class: "elsewhere" }, turn === undefined ? `not in ${name}` : `in ${name} at turn ${turn}`);
  };
  return h(
    "table",
    { class: "sides" },
    h("thead", {}, h("tr", {}, h("th", {}, ""), h("th", { scope: "col" }, "A"), h("th", { scope: "col" }, "B"))),
    h(
      "tbody",
      {},
      pairs.map((pair) => h("tr", { class: pair.a && pair.b ? "" : "differs" }, h("th", { scope: "row" }, (pair.a ?? pair.b)?.directive ?? ""), side(pair.a, a, pair.b, "A"), side(pair.b, b, pair.a, "B"))),
      pairs.length === 0 && h("tr", {}, h("td", { colspan: 3, class: "note" }, "neither chose a goal")),
    ),
  );
};

const sequencesTable = (a: Moment, b: Moment, pairs: readonly Pair<Goal>[]): Table => [
  ["decision_a", "decision_b", "place", "directive", "goal_a", "row_a", "col_a", "prize_a", "goal_b", "row_b", "col_b", "prize_b"],
  ...pairs.map(({ a: one, b: other }, i) => [
    a.number, b.number, i + 1, (one ?? other)?.directive,
    one && goalName(one.id), one?.target.row, one?.target.col, one?.prize,
    other && goalName(other.id), other?.target.row, other?.target.col, other?.prize,
  ]),
];
