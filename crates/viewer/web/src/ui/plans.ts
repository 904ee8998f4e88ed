// The plan family: as a plot and as a table, with what was proven about the choice.

import { bestFound, variants } from "../model/choice";
import type { Run } from "../model/run";
import type { Moment, PlanOption } from "../model/types";
import { MEASURES, familyFigure, familyPlot, orderOf } from "../view/family";
import type { Measure } from "../view/family";
import { heldWords } from "./choice";
import { excess } from "./compared";
import type { Writer } from "./compared";
import { h } from "./dom";
import { csvButton, figureButtons, fileName } from "./export";
import { chance, clock, energy, plain } from "./format";
import { plansTable } from "./tables";

export class PlansPage {
  private across: Measure = "prize";
  private up: Measure = "reliability";
  /** Whether the table tells differences to the chosen plan. */
  private less = false;
  /** Orders whose variants are open, by their goals. */
  private readonly open = new Set<string>();
  private shown: { moment: Moment; across: Measure; up: Measure } | undefined;

  constructor(
    private readonly page: HTMLElement,
    private readonly point: (option: number | undefined) => void,
  ) {}

  show(run: Run, moment: Moment, picked: number | undefined): void {
    const { shown, across, up } = this;
    // Pointing at a member must not rebuild what is pointed at.
    if (shown?.moment !== moment || shown.across !== across || shown.up !== up) this.build(run, moment);
    this.shown = { moment, across, up };
    for (const one of this.page.querySelectorAll<Element>("[data-option]")) one.classList.toggle("picked", one.getAttribute("data-option") === String(picked));
  }

  private build(run: Run, moment: Moment): void {
    this.page.replaceChildren(
      h("p", { class: "note proof" }, proof(moment)),
      ...heldNote(moment, run.facts.hysteresis),
      h(
        "p",
        { class: "tools" },
        this.choice("Up", this.up, (to) => (this.up = to), run, moment),
        "against",
        this.choice("Across", this.across, (to) => (this.across = to), run, moment),
        h("span", { class: "spring" }),
        ...figureButtons("the plot", (ending) => fileName(run, moment, "plans", ending), () => familyFigure(moment, this.across, this.up)),
      ),
      familyPlot(moment, this.across, this.up, undefined, { point: this.point }),
      h("p", { class: "sub" }, `The diamond is the plan chosen${bestFound(moment) === undefined ? "" : ", the square the best found"}; the larger a mark, the more energy.`),
      h("p", { class: "sub" }, `The chosen plan by each policy: ${objectiveLines(moment) || "not logged"}.`),
      h("p", { class: "tools" }, h("b", {}, "The family"), this.lessButton(moment), h("span", { class: "spring" }), csvButton("the plans", () => fileName(run, moment, "plans", "csv"), () => plansTable(moment))),
      this.table(moment),
    );
  }

  private choice(label: string, now: Measure, take: (to: Measure) => void, run: Run, moment: Moment): HTMLSelectElement {
    const select = h("select", { "aria-label": `${label}: measure of the plot` }, (Object.keys(MEASURES) as Measure[]).map((one) => h("option", { value: one, selected: one === now }, MEASURES[one].label)));
    select.addEventListener("change", () => {
      take(select.value as Measure);
      this.show(run, moment, undefined);
      this.page.querySelector<HTMLElement>(`[aria-label^="${label}:"]`)?.focus();
    });
    return select;
  }

  private lessButton(moment: Moment): HTMLElement {
    const button = h("button", { type: "button", class: "less", "aria-pressed": String(this.less) }, "differences to the chosen");
    button.addEventListener("click", () => {
      this.less = !this.less;
      button.setAttribute("aria-pressed", String(this.less));
      this.page.querySelector(".plan-table")?.replaceWith(this.table(moment));
    });
    return button;
  }

  private table(moment: Moment): HTMLElement {
    return h(
      "table",
      { class: "plan-table" },
      h("thead", {}, h("tr", {}, ["interest", "value", "reliability", "time", "energy", "order"].map((label) => h("th", { scope: "col" }, label)))),
      h("tbody", {}, variants(moment).flatMap(({ shown, folded }) => this.group(moment, shown, folded))),
    );
  }

  /** Plans of one order: those that matter, and the others on request. */
  private group(moment: Moment, shown: readonly number[], folded: readonly number[]): HTMLElement[] {
    const key = moment.family[shown[0] ?? 0]?.order.join() ?? "";
    const rest = folded.map((index) => this.row(moment, index));
    const words = (): string => `${this.open.has(key) ? "▾" : "▸"} +${folded.length} way${folded.length === 1 ? "" : "s"}`;
    const show = (): void => {
      for (const row of rest) row.hidden = !this.open.has(key);
    };
    show();
    const fold = h("button", { type: "button", class: "fold", title: "the same goals in the same order, by other ways", "aria-expanded": String(this.open.has(key)) }, words());
    fold.addEventListener("click", () => {
      if (!this.open.delete(key)) this.open.add(key);
      fold.textContent = words();
      fold.setAttribute("aria-expanded", String(this.open.has(key)));
      show();
    });
    return [...shown.map((index, i) => this.row(moment, index, folded.length > 0 && i === shown.length - 1 ? fold : undefined)), ...rest];
  }

  private row(moment: Moment, index: number, fold?: HTMLElement): HTMLElement {
    const one = moment.family[index];
    if (!one) return h("tr");
    const chosen = moment.family[moment.chosen];
    const number = (of: (plan: PlanOption) => number, write: Writer): HTMLElement =>
      h("td", { class: "number" }, this.less && chosen && index !== moment.chosen ? excess(of(one), of(chosen), write).replace("equal", "=") : write(of(one)));
    return h(
      "tr",
      {
        tabindex: 0,
        class: index === moment.chosen ? "chosen" : "",
        onpointerenter: () => this.point(index),
        onpointerleave: () => this.point(undefined),
        onfocus: () => this.point(index),
        "data-option": index,
      },
      number(({ prize }) => prize, finer),
      number(({ value }) => value, finer),
      number(({ reliability }) => reliability, chance),
      number(({ timeS }) => timeS, clock),
      number(({ energyJ }) => energyJ, energy),
      h("td", { class: "order" }, index === moment.chosen ? h("b", {}, "chosen ") : "", index === bestFound(moment) ? h("b", {}, "best found ") : "", orderOf(one), fold ? " " : "", fold),
    );
  }
}

/** Plans of one family are near to each other: a digit more than usual tells them apart. */
const finer: Writer = (value, more = 0) => plain(value, more + 1);

/** What was proven is said of the best found: that need not be the one chosen. */
const proof = (moment: Moment): string => {
  if (moment.proof !== "proven") return `The search was cut after ${moment.expansions} labels${moment.bound === undefined ? "" : `; no sequence is worth more than ${plain(moment.bound)}`}.`;
  const best = moment.family[bestFound(moment) ?? -1];
  const which = best ? `better than the best found, which is not the one chosen (value ${plain(best.value, 1)}),` : "better";
  return `Proven: no sequence ${which} of the ${moment.shortlist} goals searched (${moment.expansions} labels).`;
};

const heldNote = (moment: Moment, hysteresis: number | undefined): HTMLElement[] => {
  const words = heldWords(moment, hysteresis);
  return words ? [h("p", { class: "note held" }, h("b", {}, "Held: "), words, ".")] : [];
};

const objectiveLines = (moment: Moment): string =>
  (moment.family[moment.chosen]?.objectives ?? []).map(({ name, value }) => `${name} ${plain(value)}`).join(", ");
