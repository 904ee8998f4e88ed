// The panel: a decision's head, and one page at a time about it and the run.

import { changes } from "../model/changes";
import type { Run } from "../model/run";
import type { Moment } from "../model/types";
import type { Store, Tab } from "../state";
import { changesPage } from "./changes";
import { h } from "./dom";
import { GoalTable } from "./goals";
import { decisionHead } from "./head";
import { OtherPage } from "./other";
import { PlansPage } from "./plans";
import { RunPage } from "./runpage";

export interface PanelHandlers {
  step(by: number): void;
  seek(index: number): void;
  part(index: number): void;
  close(): void;
  pick(goal: number | undefined): void;
  option(option: number | undefined): void;
  /** What it would have taken to bring a goal in. */
  price(goal: number, decision: number): HTMLElement;
  attachment(name: string): Promise<Uint8Array<ArrayBuffer> | undefined>;
}

const TABS: readonly [Tab, string][] = [
  ["goals", "Goals"],
  ["changes", "Changes"],
  ["plans", "Plans"],
  ["run", "Run"],
  ["other", "A and B"],
];

interface Second {
  run: Run;
  index: number;
}

export class Panel {
  readonly goals: GoalTable;
  readonly other: OtherPage;
  readonly run: RunPage;
  private readonly plans: PlansPage;
  private readonly head = h("div", { class: "decision" });
  private readonly tabs = h("div", { class: "tabs", role: "tablist", "aria-label": "About this decision" });
  private readonly pages: Record<Tab, HTMLElement>;
  private offered: readonly Tab[] = [];

  constructor(
    readonly element: HTMLElement,
    private readonly store: Store,
    private readonly handlers: PanelHandlers,
  ) {
    const page = (tab: Tab): HTMLElement => h("div", { class: `page page-${tab}`, role: "tabpanel", id: `page-${tab}`, "aria-labelledby": `tab-${tab}` });
    this.pages = { goals: page("goals"), changes: page("changes"), plans: page("plans"), run: page("run"), other: page("other") };
    this.goals = new GoalTable({ pick: handlers.pick, price: handlers.price });
    this.plans = new PlansPage(this.pages.plans, handlers.option);
    this.run = new RunPage(this.pages.run, handlers);
    this.other = new OtherPage(this.pages.other, handlers);
    this.pages.goals.append(this.goals.element);
    this.tabs.addEventListener("keydown", (event) => this.tabKey(event));
    element.append(this.head, this.tabs, h("div", { class: "pages" }, Object.values(this.pages)));
  }

  show(run: Run, second: Second | undefined): void {
    const { view } = this.store;
    const moment = run.moment(view.index);
    const before = run.moment(view.index - 1);
    const changed = moment ? changes(moment, before) : [];
    this.offered = TABS.map(([tab]) => tab).filter((tab) => tab === "run" || (moment && (tab !== "other" || second)));
    const shown = this.offered.includes(view.tab) ? view.tab : (this.offered[0] ?? "run");
    this.tabBar(moment, changed.length, shown);
    if (moment) this.head.replaceChildren(...decisionHead(run, moment, view.goal, this.handlers));
    else this.head.replaceChildren(h("div", { class: "title" }, h("h2", {}, "No decision")));
    this.page(shown, run, moment, second);
  }

  /** How many decisions there are by now. */
  count(run: Run): void {
    const of = this.head.querySelector(".of");
    if (of) of.textContent = ` of ${run.moments.length}`;
  }

  /** All pages, for print: on the screen only the one in sight is made. */
  showAll(run: Run, second: Second | undefined): void {
    const moment = run.moment(this.store.view.index);
    for (const tab of this.offered) this.page(tab, run, moment, second);
    this.goals.finish();
  }

  /** The head and the pages as they are, with their titles. */
  parts(): { head: HTMLElement; pages: { title: string; page: HTMLElement }[] } {
    return { head: this.head, pages: TABS.filter(([tab]) => this.offered.includes(tab)).map(([tab, title]) => ({ title, page: this.pages[tab] })) };
  }

  private page(tab: Tab, run: Run, moment: Moment | undefined, second: Second | undefined): void {
    const { view } = this.store;
    if (tab === "run") this.run.show(run, view.index, moment);
    if (!moment) return;
    const before = run.moment(view.index - 1);
    if (tab === "goals") this.goals.show(moment, before, run.facts, view.goal);
    if (tab === "changes") this.pages.changes.replaceChildren(...changesPage(run, moment, changes(moment, before), before, this.handlers.pick));
    if (tab === "plans") this.plans.show(run, moment, view.option);
    const other = second?.run.moment(second.index);
    if (tab === "other" && second && other) this.other.show({ run, index: view.index, moment }, { run: second.run, index: second.index, moment: other });
  }

  private tabBar(moment: Moment | undefined, changed: number, shown: Tab): void {
    const counts: Partial<Record<Tab, number>> = moment ? { goals: moment.verdicts.length, changes: changed, plans: moment.family.length } : {};
    const focused = this.tabs.contains(document.activeElement);
    this.tabs.replaceChildren(
      ...TABS.filter(([tab]) => this.offered.includes(tab)).map(([tab, label]) =>
        h(
          "button",
          {
            type: "button",
            role: "tab",
            id: `tab-${tab}`,
            "aria-controls": `page-${tab}`,
            "aria-selected": String(tab === shown),
            tabindex: tab === shown ? 0 : -1,
            onclick: () => this.store.set({ tab }),
          },
          label,
          counts[tab] === undefined ? "" : h("span", { class: "count" }, counts[tab]),
        ),
      ),
    );
    if (focused) this.tabs.querySelector<HTMLElement>('[aria-selected="true"]')?.focus();
    for (const [tab] of TABS) this.pages[tab].hidden = tab !== shown;
  }

  private tabKey(event: KeyboardEvent): void {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by === 0) return;
    const at = this.offered.indexOf(this.store.view.tab);
    const next = this.offered[(at + by + this.offered.length) % this.offered.length];
    if (next) this.store.set({ tab: next });
    event.preventDefault();
    event.stopPropagation();
  }
}
