// Two decisions term by term: what differs is shown, what is equal is folded away with its count, and what differs
// first is marked.

import { placeRadiusM } from "../model/compare";
import { divergence } from "../model/divergence";
import type { Quantity, Row, Section, Taken } from "../model/divergence";
import { h } from "./dom";
import type { Table } from "./export";
import { clock, chance, energy, goalName, metres, place, plain, reason, share, trigger } from "./format";

const FORMATS: Record<Quantity, (value: number) => string> = {
  text: String,
  count: String,
  share,
  chance,
  plain,
  time: clock,
  energy,
  length: metres,
  data: (value) => `${value.toFixed(0)} MB`,
  angle: (value) => `${((value * 180) / Math.PI).toFixed(1)}°`,
};

const told = (value: number | string | undefined, of: Quantity, exact: boolean): string => {
  if (value === undefined) return "·";
  if (typeof value === "string") return value;
  return exact ? String(value) : FORMATS[of](value);
};

const less = ({ a, b, of }: Row): string => {
  if (typeof a !== "number" || typeof b !== "number") return "";
  const by = b - a;
  const size = FORMATS[of](Math.abs(by));
  // A difference too small for its format is told in digits.
  const words = by !== 0 && /^0(\.0+)?\D*$|^0:00 h$/.test(size) ? Math.abs(by).toExponential(1) : size;
  return by === 0 ? "0" : `${by > 0 ? "+" : "−"}${words}`;
};

/** Both sides in words; in all their digits if they differ by less than is written. */
const sidesOf = (row: Row): [string, string] => {
  const [a, b] = [told(row.a, row.of, false), told(row.b, row.of, false)];
  if (a !== b || row.same) return [a, b];
  // Names are each run's own: the same words may be of other places.
  return row.of === "text" ? [a, `${b} (of another place)`] : [told(row.a, row.of, true), told(row.b, row.of, true)];
};

/** A goal that one run alone knows differs in everything: its verdict says enough at first. */
const alone = ({ goal }: Section): boolean => goal !== undefined && (goal.a === undefined || goal.b === undefined);

const verdictOf = ({ goal, rows }: Section): string => {
  const side = goal?.a ? "a" : "b";
  return rows.flatMap((row) => (row.label === "verdict" || row.label === "reason" ? [row[side]] : [])).join(", ");
};

const titleOf = ({ title, goal }: Section): string => {
  if (!goal) return title;
  const { a, b } = goal;
  const one = a ?? b;
  const names = a && b ? (a.id === b.id ? `${goalName(a.id)}` : `${goalName(a.id)} in A, ${goalName(b.id)} in B`) : a ? `${goalName(a.id)}, in A alone` : b ? `${goalName(b.id)}, in B alone` : "";
  return `${names}: ${one?.directive ?? ""}${one ? ` ${place(one.target)}` : ""}`;
};

export const sectionsOf = (a: Taken, b: Taken): Section[] =>
  divergence(a, b, a.run.facts.grid, placeRadiusM(a.run, b.run), { trigger, reason, goal: goalName });

export class TermTable {
  /** Parts that were opened or shut by hand, by their titles. */
  private readonly byHand = new Map<string, boolean>();
  private sections: readonly Section[] = [];
  readonly element = h("table", { class: "terms" });

  show(a: Taken, b: Taken): void {
    this.sections = sectionsOf(a, b);
    this.render();
  }

  /** Everything, equal terms included. */
  csv(): Table {
    return [
      ["part", "goal_a", "goal_b", "term", "quantity", "a", "b", "b_less_a", "differs"],
      ...this.sections.flatMap((section) =>
        section.rows.map((row) => [
          section.goal ? "goal" : section.title,
          section.goal?.a && goalName(section.goal.a.id),
          section.goal?.b && goalName(section.goal.b.id),
          row.label,
          UNITS[row.of],
          row.a,
          row.b,
          typeof row.a === "number" && typeof row.b === "number" ? row.b - row.a : undefined,
          row.same ? "no" : "yes",
        ]),
      ),
    ];
  }

  private render(): void {
    const focused = this.element.contains(document.activeElement) ? (document.activeElement as HTMLElement).dataset.part : undefined;
    const first = this.sections.flatMap(({ rows }) => rows).find(({ same }) => !same);
    const differing = this.sections.filter(({ rows }) => rows.some(({ same }) => !same));
    // Goals that were judged otherwise before those whose numbers alone differ.
    const weight = (section: Section): number => (section.rows.includes(first as Row) ? 0 : alone(section) ? 3 : section.judged ? 1 : 2);
    const goals = differing.filter(({ goal }) => goal).sort((a, b) => weight(a) - weight(b));
    const equalGoals = this.sections.filter(({ goal, rows }) => goal && rows.every(({ same }) => same)).length;
    const others = this.sections.filter(({ goal }) => !goal);
    const parts = [...others.slice(0, -1), ...goals];
    this.element.replaceChildren(
      h("thead", {}, h("tr", {}, ["term", "A", "B", "B − A"].map((label) => h("th", { scope: "col" }, label)))),
      ...parts.map((section) => this.part(section, first)),
      ...(equalGoals > 0 ? [h("tbody", {}, note(`${equalGoals} goal${equalGoals === 1 ? " is" : "s are"} equal in every term`))] : []),
      ...others.slice(-1).map((section) => this.part(section, first)),
    );
    if (focused) [...this.element.querySelectorAll<HTMLElement>("[data-part]")].find((one) => one.dataset.part === focused)?.focus();
  }

  private part(section: Section, first: Row | undefined): HTMLElement {
    const title = titleOf(section);
    const differing = section.rows.filter(({ same }) => !same);
    const equal = section.rows.filter(({ same }) => same);
    const open = this.byHand.get(title) ?? (!section.goal || (section.judged && !alone(section)) || section.rows.includes(first as Row));
    const foldKey = `${title}: equal`;
    const unfolded = this.byHand.get(foldKey) ?? false;
    const fold = (key: string, to: boolean, words: string): HTMLElement =>
      h("button", { type: "button", class: "fold", "data-part": key, "aria-expanded": String(!to), onclick: () => this.turn(key, to) }, `${to ? "▸" : "▾"} ${words}`);
    const count = alone(section) ? verdictOf(section) : differing.length === 0 ? "nothing differs" : `${differing.length} differ${differing.length === 1 ? "s" : ""}`;
    const rows = [
      ...differing.map((row) => line(row, row === first)),
      ...(equal.length > 0 ? [h("tr", { class: "folded" }, h("td", { colspan: 4 }, fold(foldKey, !unfolded, `${equal.length} equal`)))] : []),
      ...(unfolded ? equal.map((row) => line(row, false)) : []),
    ];
    return h("tbody", {}, h("tr", { class: "part" }, h("th", { colspan: 4, scope: "rowgroup" }, fold(title, !open, title), h("span", { class: "count" }, count))), ...(open ? rows : []));
  }

  private turn(key: string, open: boolean): void {
    this.byHand.set(key, open);
    this.render();
  }
}

const UNITS: Record<Quantity, string> = { text: "text", count: "count", share: "share", chance: "probability", plain: "number", time: "s", energy: "J", length: "m", data: "MB", angle: "rad" };

const note = (words: string): HTMLElement => h("tr", { class: "folded" }, h("td", { colspan: 4 }, words));

const line = (row: Row, first: boolean): HTMLElement => {
  const [a, b] = sidesOf(row);
  const kind = row.of === "text" ? "" : "number";
  return h(
    "tr",
    { class: `${row.same ? "equal" : "differs"}${first ? " first" : ""}` },
    h("th", { scope: "row" }, row.label, first && h("span", { class: "pill" }, "differs first")),
    h("td", { class: kind, title: typeof row.a === "number" ? String(row.a) : undefined }, a),
    h("td", { class: kind, title: typeof row.b === "number" ? String(row.b) : undefined }, b),
    h("td", { class: "number" }, less(row)),
  );
};
