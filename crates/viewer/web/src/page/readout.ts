// Every value at the cell asked about, and what each expert says there.

import type { CellValues, ExpertAt } from "../derived/types";
import { at } from "../model/plane";
import type { Cell } from "../model/types";
import { DERIVED } from "../planes";
import type { View } from "../state";
import { h } from "../ui/dom";
import { goalName, place, plain, share } from "../ui/format";
import { className, title } from "./choices";
import type { Choice } from "./choices";
import type { Layers } from "./layers";
import { apart } from "./side";
import type { Side, Sides } from "./side";

/** A pointer that moves on sooner was only passing. */
const PAUSE_MS = 70;

/** Goals told of at one cell: the last that were spoken of. */
const MOST_GOALS = 4;

/** All of a log that what is told of a cell hangs on: more becomes known while it is read. */
const state = (side: Side | undefined): unknown[] => {
  const { run, index, derivable } = side ?? {};
  return [side?.serial, run?.wholeness.kind, index === undefined ? undefined : run?.moment(index)?.number, derivable && ("unavailable" in derivable ? derivable.unavailable : derivable.planes.length)];
};

const written = (choice: Choice, value: number | undefined): string => {
  if (value === undefined) return "unknown";
  if (choice.group === "uncertainty") return share(value);
  const known = choice.classes.find((one) => one.value === value);
  if (known) return className(known);
  return choice.classes.length > 0 ? `none (${plain(value)})` : plain(value);
};

export class Readout {
  readonly element = h("div", { class: "readout", "aria-live": "polite" });
  private asked: AbortController | undefined;
  private pause: number | undefined;
  private shown = "";

  constructor(
    private readonly sides: Sides,
    private readonly layers: Layers,
  ) {}

  show(view: View): void {
    const { a, b } = this.sides;
    const side = view.probed === "b" && b?.run ? b : a;
    const { probe } = view;
    const moment = side?.run?.moment(side.index);
    const shown = probe && moment ? JSON.stringify([view.probed, state(a), state(b), probe, view.layer, this.layers.choices.length]) : "";
    if (shown === this.shown) return;
    this.shown = shown;
    window.clearTimeout(this.pause);
    this.asked?.abort();
    if (!side || !moment || !probe) this.element.replaceChildren();
    else this.fill(side, moment.number, probe, view.layer);
  }

  private fill(side: Side, decision: number, cell: Cell, layer: string): void {
    // The second run may have nothing derived where the first has.
    const none = side.derivable && "unavailable" in side.derivable ? side.derivable.unavailable : undefined;
    const choices = this.layers.choices.filter(({ id }) => none === undefined || !id.startsWith(DERIVED));
    const values = new Map(choices.map((choice) => [choice.id, h("span", { class: "v" }, "…")]));
    const experts = h("div", { class: "experts" }, none ? h("p", { class: "sub" }, `no derived layers: ${none}`) : "");
    const tell = (choice: Choice, text: string): void => {
      const place = values.get(choice.id);
      if (place) place.textContent = text;
    };
    const logged = choices.filter(({ id }) => !id.startsWith(DERIVED));
    const derived = choices.filter(({ id }) => id.startsWith(DERIVED));
    const come = (found: CellValues | undefined): void => {
      for (const choice of derived) tell(choice, found ? written(choice, found.planes.get(choice.name)) : "not there");
      if (found && found.experts.length > 0) experts.replaceChildren(expertTable(found.experts));
    };
    const asked = new AbortController();
    this.asked = asked;
    const both = this.compared(cell, layer);
    this.pause = window.setTimeout(() => {
      both?.meet(asked.signal);
      for (const choice of logged) {
        // Each as it comes: some layers are put together from many looks first.
        side.planes.at(choice.id, decision).then(
          (plane) => tell(choice, written(choice, plane && at(plane, cell))),
          () => tell(choice, "not readable"),
        );
      }
      side.derived.cell(decision, cell, asked.signal).then(
        (found) => !asked.signal.aborted && come(found),
        (error: Error) => !asked.signal.aborted && (come(undefined), experts.replaceChildren(h("p", { class: "sub" }, error.message))),
      );
    }, PAUSE_MS);
    this.element.replaceChildren(this.head(side, cell), both?.line ?? "", pairs(choices, values, layer), layerTable(choices, values, layer), experts, ...this.goals(side, cell));
  }

  private head(side: Side, cell: Cell): HTMLElement {
    const grid = side.run?.facts.grid ?? { westM: 0, northM: 0, spacingM: 1 };
    const [east, north] = [grid.westM + (cell.col + 0.5) * grid.spacingM, grid.northM - (cell.row + 0.5) * grid.spacingM];
    const which = this.sides.b ? (side === this.sides.b ? "B, " : "A, ") : "";
    return h("p", {}, h("b", {}, `${which}cell ${place(cell)}`), ` ${east.toFixed(1)} m E, ${north.toFixed(1)} m N`);
  }

  /** The layer shown, of both runs: a line for it, and how it is met. */
  private compared(cell: Cell, layer: string): { line: HTMLElement; meet(signal: AbortSignal): void } | undefined {
    const { a, b } = this.sides;
    const choice = this.layers.choices.find(({ id }) => id === layer);
    // On other ground the cell is another place.
    if (!a || !b || !choice || apart(this.sides)) return undefined;
    const line = h("p", { class: "both" }, "…");
    const value = async (side: Side): Promise<number | undefined> => {
      const plane = await side.layer(layer, false, false);
      return plane && at(plane, cell);
    };
    const told = ([one, other]: readonly (number | undefined)[]): string => {
      const less = one !== undefined && other !== undefined && choice.classes.length === 0 ? `, A − B ${plain(one - other)}` : "";
      return `${choice.name}: A ${written(choice, one)}, B ${written(choice, other)}${less}`;
    };
    const meet = (signal: AbortSignal): void => {
      const say = (words: string): void => {
        if (!signal.aborted) line.textContent = words;
      };
      Promise.all([value(a), value(b)]).then((values) => say(told(values)), () => say(`${choice.name}: not of both runs`));
    };
    return { line, meet };
  }

  private goals({ run, index }: Side, cell: Cell): HTMLElement[] {
    const here = [...(run?.verdictsUpTo(index).values() ?? [])].filter(({ verdict }) => verdict.goal.target.row === cell.row && verdict.goal.target.col === cell.col);
    const shown = here.sort((one, other) => other.index - one.index || other.verdict.goal.id - one.verdict.goal.id).slice(0, MOST_GOALS);
    const more = here.length - shown.length;
    return [...shown.map(({ verdict }) => h("p", {}, `${goalName(verdict.goal.id)} ${verdict.goal.directive}: ${verdict.action}, ${verdict.reason}`)), ...(more > 0 ? [h("p", { class: "sub" }, `and ${more} earlier`)] : [])];
  }
}

/** What is one number a cell, two to a line. */
const pairs = (choices: readonly Choice[], values: ReadonlyMap<string, HTMLElement>, layer: string): HTMLElement =>
  h(
    "dl",
    { class: "pairs" },
    choices
      .filter(({ group }) => group === "interest" || group === "ground" || group === "other maps")
      .map((choice) => h("div", { class: choice.id === layer ? "on" : "", title: title(choice) }, h("dt", {}, choice.unit ? `${choice.name}, ${choice.unit}` : choice.name), h("dd", {}, values.get(choice.id)))),
  );

/** What instruments read: as it was used and as it was read, each with its uncertainty. */
const layerTable = (choices: readonly Choice[], values: ReadonlyMap<string, HTMLElement>, layer: string): HTMLElement => {
  const find = (id: string): Choice | undefined => choices.find((choice) => choice.id === id);
  const used = (name: string): Choice | undefined => choices.find((one) => one.name === name && (one.group === "layers as used" || one.group === "uncertainty") && !one.id.startsWith("doubt:"));
  const first = find("map:elevation");
  const names = [...new Set(choices.filter(({ group }) => group === "readings as logged" || group === "layers as used").map(({ name }) => name))];
  const columns: [string, (name: string) => Choice | undefined][] = [
    ["used", used],
    ["u", (name) => used(`${name}-u`)],
    ["as read", (name) => find(`read:${name}`) ?? (name === "elevation" ? first : undefined)],
    ["u", (name) => find(`doubt:${name}`)],
  ];
  const there = columns.filter(([, of]) => names.some((name) => of(name)));
  const unit = (name: string): string => choices.find((one) => one.name === name && one.unit)?.unit ?? "";
  return h(
    "table",
    { class: "values" },
    h("thead", {}, h("tr", {}, h("th", {}), there.map(([label]) => h("th", {}, label)))),
    h(
      "tbody",
      {},
      names.map((name) => h("tr", {}, h("th", {}, unit(name) ? `${name}, ${unit(name)}` : name), there.map(([, of]) => h("td", { class: of(name)?.id === layer ? "on" : "" }, values.get(of(name)?.id ?? "") ?? "")))),
    ),
  );
};

const MASSES = ["I", "NI", "I∪NI", "I∩NI"] as const;

/** Masses of each expert, and its share in Bel(I). */
const expertTable = (experts: readonly ExpertAt[]): HTMLElement => {
  const mass = (value: number | undefined): HTMLElement => h("td", {}, value === undefined ? "" : value.toFixed(3));
  return h(
    "table",
    { class: "values" },
    h("thead", {}, h("tr", {}, h("th", {}, "masses"), MASSES.map((label) => h("th", {}, label)), h("th", { title: "exact share of the expert in Bel(I)" }, "credit"))),
    h(
      "tbody",
      {},
      experts.map(({ name, masses, credit }) =>
        h("tr", {}, h("th", { title: name }, name), mass(masses?.interesting), mass(masses?.notInteresting), mass(masses?.ignorance), mass(masses?.paradox), h("td", { class: "credit-at" }, credit === undefined ? "none" : credit.toFixed(4))),
      ),
    ),
  );
};
