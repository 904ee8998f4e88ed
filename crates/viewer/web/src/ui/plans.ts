// The plan family: as a plot and as a table, with what was proven about the choice.

import type { Run } from "../model/run";
import type { Moment } from "../model/types";
import { MEASURES, familyFigure, familyPlot, orderOf } from "../view/family";
import type { Measure } from "../view/family";
import { h } from "./dom";
import { csvButton, figureButtons, fileName } from "./export";
import { chance, clock, energy, plain } from "./format";
import { plansTable } from "./tables";

export class PlansPage {
  private across: Measure = "prize";
  private up: Measure = "reliability";
  private shown = "";

  constructor(
    private readonly page: HTMLElement,
    private readonly point: (option: number | undefined) => void,
  ) {}

  show(run: Run, moment: Moment, picked: number | undefined): void {
    const shown = `${run.facts.name}/${moment.number}/${this.across}/${this.up}`;
    // Pointing at a member must not rebuild what is pointed at.
    if (shown !== this.shown || this.page.childElementCount === 0) this.build(run, moment);
    this.shown = shown;
    for (const one of this.page.querySelectorAll<Element>("[data-option]")) one.classList.toggle("picked", one.getAttribute("data-option") === String(picked));
  }

  private build(run: Run, moment: Moment): void {
    this.page.replaceChildren(
      h("p", { class: "note" }, proof(moment)),
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
      h("p", { class: "sub" }, "The diamond is the plan chosen; the larger a mark, the more energy."),
      h("p", { class: "sub" }, `The chosen plan by each policy: ${objectiveLines(moment) || "not logged"}.`),
      h("p", { class: "tools" }, h("b", {}, "The family"), h("span", { class: "spring" }), csvButton("the plans", () => fileName(run, moment, "plans", "csv"), () => plansTable(moment))),
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

  private table(moment: Moment): HTMLElement {
    const rows = moment.family.map((one, index) =>
      h(
        "tr",
        {
          tabindex: 0,
          class: index === moment.chosen ? "chosen" : "",
          onpointerenter: () => this.point(index),
          onpointerleave: () => this.point(undefined),
          onfocus: () => this.point(index),
          "data-option": index,
        },
        h("td", { class: "number" }, plain(one.prize)),
        h("td", { class: "number" }, plain(one.value)),
        h("td", { class: "number" }, chance(one.reliability)),
        h("td", { class: "number" }, clock(one.timeS)),
        h("td", { class: "number" }, energy(one.energyJ)),
        h("td", { class: "order" }, index === moment.chosen ? h("b", {}, "chosen ") : "", orderOf(one)),
      ),
    );
    return h(
      "table",
      { class: "plan-table" },
      h("thead", {}, h("tr", {}, ["interest", "value", "reliability", "time", "energy", "order"].map((label) => h("th", { scope: "col" }, label)))),
      h("tbody", {}, rows),
    );
  }
}

const proof = (moment: Moment): string =>
  moment.proof === "proven"
    ? `Proven: no better sequence of the ${moment.shortlist} goals searched (${moment.expansions} labels).`
    : `The search was cut after ${moment.expansions} labels${moment.bound === undefined ? "" : `; no sequence is worth more than ${plain(moment.bound)}`}.`;

const objectiveLines = (moment: Moment): string =>
  (moment.family[moment.chosen]?.objectives ?? []).map(({ name, value }) => `${name} ${plain(value)}`).join(", ");
