// The panel: a decision's head, and one page at a time about it and the run.

import { changes } from "../model/changes";
import type { Run } from "../model/run";
import type { Moment } from "../model/types";
import type { Store, Tab } from "../state";
import { changesPage } from "./changes";
import { h } from "./dom";
import { GoalTable } from "./goals";
import { decisionHead, ofWords } from "./head";
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
  /** Lets the panel tell of the other run. */
  turn(subject: "a" | "b"): void;
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

/** A run, and the decision it stands at. */
interface Stand {
  run: Run;
  index: number;
}

/** What sets a run apart from the other, in a word or two. */
const apart = (run: Run, other: Run): string => {
  const words = ["rule", "policy", "seed"].flatMap((key) => (run.facts.run[key] === other.facts.run[key] ? [] : [key === "seed" ? `seed ${run.facts.run[key]}` : (run.facts.run[key] ?? "")]));
  return words.filter(Boolean).join(", ") || run.facts.name;
};

export class Panel {
  readonly goals: GoalTable;
  readonly other: OtherPage;
  readonly run: RunPage;
  private readonly plans: PlansPage;
  private readonly head = h("div", { class: "decision" });
  private readonly switch = h("div", { class: "subject", role: "group", "aria-label": "Run told of (x)", hidden: true });
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
    element.append(this.switch, this.head, this.tabs, h("div", { class: "pages" }, Object.values(this.pages)));
  }

  show(first: Stand, second: Stand | undefined): void {
    const { view } = this.store;
    const { run, index } = this.lead(first, second);
    const moment = run.moment(index);
    const changed = moment ? changes(moment, run.moment(index - 1)) : [];
    this.offered = TABS.map(([tab]) => tab).filter((tab) => tab === "run" || (moment && (tab !== "other" || second)));
    const shown = this.offered.includes(view.tab) ? view.tab : (this.offered[0] ?? "run");
    this.subjects(first, second);
    this.tabBar(moment, changed.length, shown);
    if (moment) this.head.replaceChildren(...decisionHead(run, moment, view.goal, this.handlers));
    else this.head.replaceChildren(h("div", { class: "title" }, h("h2", {}, "No decision")));
    this.page(shown, first, second);
  }

  /** How many decisions there are by now. */
  count(run: Run): void {
    const of = this.head.querySelector(".of");
    if (of) of.textContent = ofWords(run);
  }

  /** All pages, for print: on the screen only the one in sight is made. */
  showAll(first: Stand, second: Stand | undefined): void {
    for (const tab of this.offered) this.page(tab, first, second);
    this.goals.finish();
  }

  /** The head and the pages as they are, with their titles. */
  parts(): { head: HTMLElement; pages: { title: string; page: HTMLElement }[] } {
    return { head: this.head, pages: TABS.filter(([tab]) => this.offered.includes(tab)).map(([tab, title]) => ({ title, page: this.pages[tab] })) };
  }

  /** The run that the panel tells of. */
  private lead(first: Stand, second: Stand | undefined): Stand {
    return (this.store.view.subject === "b" && second) || first;
  }

  /** Which of two runs is told of, to be seen and changed. */
  private subjects(first: Stand, second: Stand | undefined): void {
    this.switch.hidden = second === undefined;
    if (!second) return;
    const told = this.lead(first, second) === second ? "b" : "a";
    const focused = this.switch.contains(document.activeElement);
    const button = (of: "a" | "b", { run, index }: Stand, other: Run): HTMLElement =>
      h(
        "button",
        { type: "button", "aria-pressed": String(of === told), title: `${run.facts.name}: the panel tells of this run (x)`, onclick: () => this.handlers.turn(of) },
        h("b", {}, of.toUpperCase()),
        ` ${apart(run, other)}, decision ${run.moment(index)?.number ?? "none"}`,
      );
    this.switch.replaceChildren(button("a", first, second.run), button("b", second, first.run));
    if (focused) this.switch.querySelector<HTMLElement>('[aria-pressed="true"]')?.focus();
  }

  private page(tab: Tab, first: Stand, second: Stand | undefined): void {
    const { view } = this.store;
    const { run, index } = this.lead(first, second);
    const moment = run.moment(index);
    if (tab === "run") this.run.show(run, index, moment);
    if (!moment) return;
    const before = run.moment(index - 1);
    if (tab === "goals") this.goals.show(moment, before, run.facts, view.goal);
    if (tab === "changes") this.pages.changes.replaceChildren(...changesPage(run, moment, changes(moment, before), before, this.handlers.pick));
    if (tab === "plans") this.plans.show(run, moment, view.option);
    const [one, other] = [first.run.moment(first.index), second?.run.moment(second.index)];
    if (tab === "other" && second && one && other) this.other.show({ ...first, moment: one }, { ...second, moment: other });
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
