// The table of all goals of a decision: sorted, filtered, opened.

import { changes } from "../model/changes";
import { STATES, reliability, stateLabel, stateOf } from "../model/states";
import type { GoalState } from "../model/states";
import type { Goal, Moment, RunFacts, Verdict } from "../model/types";
import { OKABE } from "../view/colour";
import { markIcon } from "../view/marks";
import { h } from "./dom";
import { csv } from "./export";
import { chance, goalName, place, reason, share, termOf } from "./format";
import { changeSaying, saying } from "./sayings";
import { goalsTable } from "./tables";

type Column = "turn" | "goal" | "interest" | "prize" | "reliability" | "verdict";

export interface GoalHandlers {
  pick(goal: number | undefined): void;
  /** What it would have taken to bring a goal in. */
  price(goal: number, decision: number): HTMLElement;
}

const EXPERT_COLOURS = [OKABE.blue, OKABE.orange, OKABE.green, OKABE.pink, OKABE.sky, OKABE.vermilion];

/** Rows made at once, and then at every frame: a mission may know hundreds of goals. */
const AT_ONCE = 40;
const A_FRAME = 20;

/** Turns first, in their order, then what is out of the plan by what it is worth. */
const byTurn = (a: Verdict, b: Verdict): number =>
  (a.turn ?? Number.POSITIVE_INFINITY) - (b.turn ?? Number.POSITIVE_INFINITY) || b.goal.prize - a.goal.prize;

export class GoalTable {
  readonly element = h("div", { class: "goals" });
  private readonly filter = h("input", { type: "search", placeholder: "Filter: G7, energy, rock …", "aria-label": "Filter goals" });
  private readonly chips = h("div", { class: "chips", role: "group", "aria-label": "States shown" });
  private readonly body = h("tbody");
  private readonly head = h("thead");
  private sort: { column: Column; down: boolean } = { column: "turn", down: false };
  private readonly hidden = new Set<GoalState>();
  private shown: { moment: Moment; before: Moment | undefined; facts: RunFacts; goal: number | undefined } | undefined;

  private rest: (() => HTMLElement[])[] = [];
  private frame = 0;

  constructor(private readonly handlers: GoalHandlers) {
    this.filter.addEventListener("input", () => this.render());
    this.filter.addEventListener("keydown", (event) => this.openFirst(event));
    this.element.append(
      h("div", { class: "tools" }, this.filter, this.chips),
      h("table", { class: "goal-table" }, this.head, this.body),
    );
  }

  focus(): void {
    (this.body.querySelector<HTMLElement>("tr.picked") ?? this.body.querySelector<HTMLElement>("tr"))?.focus();
  }

  show(moment: Moment, before: Moment | undefined, facts: RunFacts, goal: number | undefined): void {
    const picked = this.shown?.goal !== goal;
    this.shown = { moment, before, facts, goal };
    this.render();
    if (picked && goal !== undefined) this.body.querySelector(`tr[data-goal="${goal}"]`)?.scrollIntoView({ block: "nearest" });
  }

  csv(): string {
    return this.shown ? csv(goalsTable(this.shown.moment)) : "";
  }

  private render(): void {
    const { shown } = this;
    if (!shown) return;
    const { moment, before } = shown;
    const focused = document.activeElement instanceof HTMLElement && this.body.contains(document.activeElement) ? document.activeElement.dataset.goal : undefined;
    this.states(moment);
    this.header();
    const changed = new Map(changes(moment, before).map((change) => [change.goal, change.kind]));
    const wanted = this.filter.value.trim().toLowerCase();
    const rows = moment.verdicts
      .filter((verdict) => !this.hidden.has(stateOf(verdict, moment)))
      .filter((verdict) => wanted === "" || this.words(verdict).includes(wanted))
      .sort((a, b) => this.compare(a, b, moment));
    const made = (verdict: Verdict): HTMLElement[] => {
      const open = verdict.goal.id === shown.goal;
      const row = this.row(verdict, moment, open, before ? changed.get(verdict.goal.id) : undefined);
      return open ? [row, this.detail(verdict, moment, shown.facts)] : [row];
    };
    // As far down as what is picked or has the focus, and a screenful beyond; the rest follows frame by frame.
    const needed = rows.findLastIndex(({ goal }) => goal.id === shown.goal || String(goal.id) === focused);
    const first = Math.max(AT_ONCE, needed + AT_ONCE / 2);
    this.body.replaceChildren(...rows.slice(0, first).flatMap(made));
    this.rest = rows.slice(first).map((verdict) => () => made(verdict));
    this.goOn();
    if (rows.length === 0) this.body.append(h("tr", {}, h("td", { colspan: 5, class: "none" }, "No goal fits.")));
    if (focused) this.body.querySelector<HTMLElement>(`tr[data-goal="${focused}"]`)?.focus({ preventScroll: true });
  }

  /** Makes the rows that are not made yet: paper does not wait. */
  finish(): void {
    this.body.append(...this.rest.flatMap((row) => row()));
    this.rest = [];
  }

  private goOn(): void {
    window.cancelAnimationFrame(this.frame);
    if (this.rest.length === 0) return;
    this.frame = window.requestAnimationFrame(() => {
      this.body.append(...this.rest.slice(0, A_FRAME).flatMap((row) => row()));
      this.rest = this.rest.slice(A_FRAME);
      this.goOn();
    });
  }

  private words({ goal, action, reason: why }: Verdict): string {
    return `${goalName(goal.id)} ${goal.directive} ${goal.kind} ${action} ${why}`.toLowerCase();
  }

  private states(moment: Moment): void {
    const counts = new Map<GoalState, number>();
    for (const verdict of moment.verdicts) {
      const state = stateOf(verdict, moment);
      counts.set(state, (counts.get(state) ?? 0) + 1);
    }
    this.chips.replaceChildren(
      ...STATES.filter((state) => counts.has(state)).map((state) =>
        h(
          "button",
          {
            class: "chip",
            type: "button",
            "aria-pressed": String(!this.hidden.has(state)),
            onclick: () => {
              if (!this.hidden.delete(state)) this.hidden.add(state);
              this.render();
            },
          },
          markIcon(state),
          `${stateLabel[state]} ${counts.get(state)}`,
        ),
      ),
    );
  }

  private header(): void {
    const columns: [Column, string, string][] = [
      ["goal", "Goal", "name and directive"],
      ["interest", "Interest", "Bel(I) at the target"],
      ["prize", "Prize", "the directive's weight times the prize of the map at the target"],
      ["reliability", "R so far", "chance to get as far as this goal by the chosen plan"],
      ["verdict", "Verdict and reason", "what was done with it, why, and the numbers compared"],
    ];
    this.head.replaceChildren(
      h(
        "tr",
        {},
        columns.map(([column, label, title]) => {
          const sorted = this.sort.column === column;
          const by = sorted ? (this.sort.down ? "descending" : "ascending") : "none";
          return h(
            "th",
            { "aria-sort": by, title, class: column },
            h("button", { type: "button", onclick: () => this.sortBy(column) }, label, sorted ? (this.sort.down ? " ↓" : " ↑") : ""),
          );
        }),
      ),
    );
  }

  /** Down, up, and back to the plan's order. */
  private sortBy(column: Column): void {
    const numeric = column !== "goal" && column !== "verdict";
    if (this.sort.column !== column) this.sort = { column, down: numeric };
    else if (this.sort.down === numeric) this.sort = { column, down: !numeric };
    else this.sort = { column: "turn", down: false };
    this.render();
  }

  private compare(a: Verdict, b: Verdict, moment: Moment): number {
    const { column, down } = this.sort;
    const sign = down ? -1 : 1;
    switch (column) {
      case "turn":
        return byTurn(a, b);
      case "goal":
        return sign * (a.goal.id - b.goal.id);
      case "interest":
        return sign * (a.goal.interest - b.goal.interest);
      case "prize":
        return sign * (a.goal.prize - b.goal.prize);
      case "reliability":
        return sign * ((reliability(a, moment) ?? -1) - (reliability(b, moment) ?? -1));
      case "verdict":
        return sign * `${a.action} ${a.reason}`.localeCompare(`${b.action} ${b.reason}`) || byTurn(a, b);
    }
  }

  private row(verdict: Verdict, moment: Moment, open: boolean, changed: string | undefined): HTMLTableRowElement {
    const { goal } = verdict;
    const state = stateOf(verdict, moment);
    const so = reliability(verdict, moment);
    const row = h(
      "tr",
      {
        tabindex: 0,
        "data-goal": goal.id,
        class: `goal ${state}${open ? " picked" : ""}`,
        "aria-expanded": String(open),
        onclick: () => this.handlers.pick(open ? undefined : goal.id),
        onkeydown: (event: KeyboardEvent) => this.key(event, goal.id, open),
      },
      h(
        "td",
        { class: "goal" },
        markIcon(state),
        h("span", { class: "name" }, goalName(goal.id)),
        verdict.turn === undefined ? "" : h("span", { class: "turn" }, `${verdict.turn + 1}.`),
        changed ? h("span", { class: "changed", title: "changed since the last decision" }, changed) : "",
        h("div", { class: "sub" }, goal.directive),
      ),
      h("td", { class: "number" }, share(goal.interest)),
      h("td", { class: "number" }, share(goal.prize)),
      h("td", { class: "number" }, so === undefined ? "·" : chance(so)),
      h("td", { class: "why", title: saying(verdict, moment) }, h("b", {}, verdict.action), " ", reason(verdict), h("div", { class: "saying" }, saying(verdict, moment))),
    );
    return row;
  }

  /** Enter in the filter opens the first goal that fits, and goes there. */
  private openFirst(event: KeyboardEvent): void {
    const first = this.body.querySelector<HTMLElement>("tr[data-goal]");
    if (event.key !== "Enter" || !first) return;
    event.preventDefault();
    this.handlers.pick(Number(first.dataset.goal));
    first.focus();
  }

  private key(event: KeyboardEvent, goal: number, open: boolean): void {
    const row = event.currentTarget as HTMLElement;
    const step = (to: "nextElementSibling" | "previousElementSibling"): void => {
      let next = row[to];
      while (next && !(next instanceof HTMLElement && next.dataset.goal)) next = next[to];
      (next as HTMLElement | null)?.focus();
    };
    if (event.key === "Enter") this.handlers.pick(open ? undefined : goal);
    else if (event.key === "ArrowDown") step("nextElementSibling");
    else if (event.key === "ArrowUp") step("previousElementSibling");
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private detail(verdict: Verdict, moment: Moment, facts: RunFacts): HTMLTableRowElement {
    const { goal, changes: own, steps, cause, action, turn } = verdict;
    const total = goal.credit.reduce((sum, part) => sum + Math.abs(part), 0) || 1;
    const name = (i: number): string => facts.experts[i] ?? `expert ${i + 1}`;
    const bar = h("div", { class: "credit", role: "img", "aria-label": "share of each expert in the interest" });
    const key = h("div", { class: "credit-key" });
    goal.credit.forEach((part, i) => {
      const piece = h("span");
      // Set by property, not by attribute: the page's policy allows it, and the numbers come from the log.
      piece.classList.toggle("negative", part < 0);
      piece.style.width = `${(100 * Math.abs(part)) / total}%`;
      piece.style.background = EXPERT_COLOURS[i % EXPERT_COLOURS.length] ?? OKABE.grey;
      bar.append(piece);
      const dot = h("i");
      dot.style.background = piece.style.background;
      dot.classList.toggle("negative", part < 0);
      key.append(h("span", {}, dot, `${name(i)} ${(100 * part).toFixed(1)} %`));
    });
    const facts_: [string, string][] = [
      ["target", place(goal.target)],
      ["kind", goal.kind],
      ["prominence", share(goal.prominence)],
      ["ignorance", share(goal.ignorance)],
      ["paradox", share(goal.paradox)],
      ["contradiction", share(goal.contradiction)],
      ["region", `${goal.regionCells} cell${goal.regionCells === 1 ? "" : "s"}`],
      ["failed tries", String(goal.attempts)],
      ["born", `decision ${goal.born}${goal.parent === undefined ? "" : `, split off ${goalName(goal.parent)}`}`],
      ["looked at for", goal.commanded ? `${cause}, commanded` : cause],
      ["status", goal.status],
    ];
    return h(
      "tr",
      { class: "detail" },
      h(
        "td",
        { colspan: 5 },
        h("p", { class: "meaning" }, saying(verdict, moment)),
        h("p", {}, h("b", {}, "prize "), prizeParts(goal, facts)),
        goal.credit.length > 0 && h("p", { class: "credit-title" }, h("b", {}, "Credit"), ", each expert's exact share of the interest", goal.credit.some((part) => part < 0) ? "; striped: below 0, it speaks against" : ""),
        goal.credit.length > 0 && bar,
        goal.credit.length > 0 && key,
        h("dl", {}, facts_.flatMap(([label, value]) => [h("div", {}, h("dt", {}, label), h("dd", {}, value))])),
        own.map((change) =>
          h("p", { title: changeSaying(change.transformation, change.reason) }, h("b", {}, change.transformation), ` ${change.reason}`, change.other === undefined ? "" : ` ${goalName(change.other)}`, change.terms.length > 0 ? `: ${change.terms.map((of) => termOf(change.reason, of)).join(", ")}` : "", h("span", { class: "sub" }, ` ${changeSaying(change.transformation, change.reason)}`)),
        ),
        steps.length > 0 &&
          h("p", { class: "life" }, [steps[0]?.from ?? "", ...steps.map((step) => `${step.to}${step.outcome ? ` (${step.outcome})` : ""}`)].join(" › ")),
        // A goal left out has a price.
        turn === undefined && action !== "achieve" && this.handlers.price(goal.id, moment.number),
      ),
    );
  }
}

/** What the prize is made of, where the mission's file tells the weight; a command names its own. */
const prizeParts = ({ directive, prize, commanded }: Goal, { weights, run }: RunFacts): string => {
  const weight = weights.get(directive);
  if (commanded) return `${chance(prize)}, as commanded`;
  if (weight === undefined || weight <= 0) return chance(prize);
  return `${chance(prize)} = weight ${weight} of ${directive} × unweighted prize ${chance(prize / weight)}${run.prize ? ` (the map's, by ${run.prize})` : ""}`;
};
