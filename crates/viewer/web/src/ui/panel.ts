// The decision panel: why it was due, what was chosen, and what was said of every goal.

import { changes } from "../model/changes";
import type { ChangeKind, GoalChange } from "../model/changes";
import type { Run } from "../model/run";
import { stateOf } from "../model/states";
import type { Moment } from "../model/types";
import type { Store, Tab } from "../state";
import { familyPlot, orderOf } from "../view/family";
import { markIcon } from "../view/marks";
import { Trend } from "../view/trend";
import { h, save } from "./dom";
import { bytes, chance, clock, energy, goalName, metres, place, plain, reason, share, term, trigger } from "./format";
import { GoalTable, objectiveLines } from "./goals";
import { otherPage } from "./other";

export interface PanelHandlers {
  /** What it would have taken to bring a goal in. */
  price(goal: number, decision: number): HTMLElement;
  step(by: number): void;
  seek(index: number): void;
  part(index: number): void;
  close(): void;
  pick(goal: number | undefined): void;
  option(option: number | undefined): void;
  attachment(name: string): Promise<string | undefined>;
}

const CHANGE_WORDS: Record<ChangeKind, string> = {
  done: "Done",
  dropped: "Dropped",
  entered: "Entered the plan",
  left: "Left the plan",
  moved: "Moved in the plan",
  altered: "Changed in itself",
  found: "Newly found, not in the plan",
};

const TABS: readonly [Tab, string][] = [
  ["goals", "Goals"],
  ["changes", "Changes"],
  ["plans", "Plans"],
  ["run", "Run"],
  ["other", "A and B"],
];

export class Panel {
  readonly goals: GoalTable;
  private readonly head = h("div", { class: "decision" });
  private readonly tabs = h("div", { class: "tabs", role: "tablist", "aria-label": "About this decision" });
  private readonly pages: Record<Tab, HTMLElement>;
  private readonly trendPlace = h("div", { class: "trend" });
  private readonly trend: Trend;
  private second: { run: Run; index: number } | undefined;

  constructor(
    readonly element: HTMLElement,
    private readonly store: Store,
    private readonly handlers: PanelHandlers,
  ) {
    this.goals = new GoalTable({ pick: handlers.pick, price: handlers.price });
    this.trend = new Trend(this.trendPlace, handlers.seek);
    const page = (tab: Tab): HTMLElement => h("div", { class: `page page-${tab}`, role: "tabpanel", id: `page-${tab}`, "aria-labelledby": `tab-${tab}` });
    this.pages = { goals: page("goals"), changes: page("changes"), plans: page("plans"), run: page("run"), other: page("other") };
    this.pages.goals.append(this.goals.element);
    this.tabs.addEventListener("keydown", (event) => this.tabKey(event));
    element.append(this.head, this.tabs, h("div", { class: "pages" }, Object.values(this.pages)));
  }

  show(run: Run, second: { run: Run; index: number } | undefined): void {
    const { view } = this.store;
    this.second = second;
    const moment = run.moment(view.index);
    const before = run.moment(view.index - 1);
    if (!moment) return;
    const changed = changes(moment, before);
    this.header(run, moment);
    this.tabBar(moment, changed.length);
    // Pages out of sight are only made for print: one is shown at a time.
    if (view.tab === "goals") this.goals.show(moment, before, run.facts, view.goal);
    if (view.tab === "changes") this.changes(changed, before);
    if (view.tab === "plans") this.plans(moment);
    if (view.tab === "run") this.run(run, moment);
    const other = second?.run.moment(second.index);
    if (view.tab === "other" && second && other) this.pages.other.replaceChildren(...otherPage(run, second.run, moment, other, this.handlers));
  }

  private header(run: Run, moment: Moment): void {
    const outcome = run.outcomes.get(moment.number);
    const chosen = moment.family[moment.chosen];
    const { act } = moment;
    const drive = act.name === "pursue" && act.lengthM === 0 ? ", from where it stands" : act.lengthM > 0 ? `, ${metres(act.lengthM)} in ${clock(act.timeS)}, reliability ${chance(act.reliability)}` : "";
    const what = act.name === "pursue" && act.goal !== undefined ? `pursue ${goalName(act.goal)}` : act.name;
    const wake = act.wake ? `, until ${act.wake}` : "";
    this.head.replaceChildren(
      h(
        "div",
        { class: "title" },
        h("button", { type: "button", class: "step", title: "Decision before (←)", "aria-label": "Decision before", onclick: () => this.handlers.step(-1) }, "‹"),
        h("h2", {}, `Decision ${moment.number}`, h("small", {}, ` of ${run.moments.length}`)),
        h("button", { type: "button", class: "step", title: "Next decision (→)", "aria-label": "Next decision", onclick: () => this.handlers.step(1) }, "›"),
        h("p", { class: "where" }, `${clock(moment.timeS)} · ${metres(moment.spent.lengthM)} driven · rover at ${place(moment.pose)}`),
      ),
      h(
        "dl",
        { class: "story" },
        h("dt", {}, "because"),
        h("dd", {}, moment.triggers.map((one) => h("span", { class: "trigger" }, trigger(one)))),
        h("dt", {}, "so"),
        h("dd", {}, h("b", {}, what), drive, wake, moment.held ? h("span", { class: "pill", title: "The committed sequence stays: another is better, but not by enough" }, "held") : ""),
        ...(outcome
          ? [
              h("dt", {}, "came of it"),
              h("dd", {}, h("b", {}, outcome.result), outcome.goal === undefined ? "" : ` ${goalName(outcome.goal)}`, ` at ${clock(outcome.spent.timeS)}`, outcome.track.length > 1 ? `, ${cells(outcome.track.length - 1)} driven` : "", outcome.operators.length > 0 ? `; ${outcome.operators.join(", ")}` : ""),
            ]
          : []),
      ),
      this.sequence(moment),
      chosen && chosen.order.length > 0
        ? h(
            "div",
            { class: "numbers" },
            figure("value", plain(chosen.value)),
            figure("reliability", chance(chosen.reliability)),
            figure("time", clock(chosen.timeS)),
            figure("energy", energy(chosen.energyJ)),
            figure("data", `${chosen.dataMb.toFixed(0)} MB`),
            figure("way", metres(chosen.lengthM)),
          )
        : h("p", { class: "note" }, "No sequence of goals was chosen."),
    );
  }

  /** The chosen order, as buttons. */
  private sequence(moment: Moment): HTMLElement {
    const { view } = this.store;
    return h(
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
              class: leg.goal === view.goal ? "picked" : "",
              title: `${verdict?.goal.directive ?? ""}: ${leg.operators.join(", ")}; ${metres(leg.lengthM)}, reliability ${chance(leg.reliability)}`,
              onclick: () => this.handlers.pick(leg.goal === view.goal ? undefined : leg.goal),
            },
            verdict ? markIcon(stateOf(verdict, moment)) : "",
            goalName(leg.goal),
          ),
        );
      }),
    );
  }

  private tabBar(moment: Moment, changed: number): void {
    const { view } = this.store;
    const counts: Partial<Record<Tab, number>> = { goals: moment.verdicts.length, changes: changed, plans: moment.family.length };
    const focused = this.tabs.contains(document.activeElement);
    this.tabs.replaceChildren(
      ...TABS.filter(([tab]) => tab !== "other" || this.second).map(([tab, label]) =>
        h(
          "button",
          {
            type: "button",
            role: "tab",
            id: `tab-${tab}`,
            "aria-controls": `page-${tab}`,
            "aria-selected": String(tab === view.tab),
            tabindex: tab === view.tab ? 0 : -1,
            onclick: () => this.store.set({ tab }),
          },
          label,
          counts[tab] === undefined ? "" : h("span", { class: "count" }, counts[tab]),
        ),
      ),
    );
    if (focused) this.tabs.querySelector<HTMLElement>('[aria-selected="true"]')?.focus();
    for (const [tab] of TABS) this.pages[tab].hidden = tab !== view.tab;
  }

  private tabKey(event: KeyboardEvent): void {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by === 0) return;
    const tabs = TABS.filter(([tab]) => tab !== "other" || this.second);
    const at = tabs.findIndex(([tab]) => tab === this.store.view.tab);
    const next = tabs[(at + by + tabs.length) % tabs.length];
    if (next) this.store.set({ tab: next[0] });
    event.preventDefault();
    event.stopPropagation();
  }

  private changes(changed: readonly GoalChange[], before: Moment | undefined): void {
    const kinds = [...new Set(changed.map((change) => change.kind))];
    const turn = (at: number | undefined): string => (at === undefined ? "" : `${at + 1}.`);
    const line = (change: GoalChange): HTMLElement => {
      const { goal } = change.verdict;
      const bits = [
        change.kind === "entered" ? `turn ${turn(change.to)}` : "",
        change.kind === "left" ? `was ${turn(change.from)}` : "",
        change.kind === "moved" ? `${turn(change.from)} → ${turn(change.to)}` : "",
        change.targetWas ? `target ${place(change.targetWas)} → ${place(goal.target)}` : "",
        change.prizeWas === undefined ? "" : `prize ${share(change.prizeWas)} → ${share(goal.prize)}`,
        ...change.verdict.changes.map((one) => [one.transformation, one.reason, one.terms.map(term).join(", ")].filter(Boolean).join(" ")),
        // Said already, if the goal itself changed for it.
        change.kind === "altered" || change.verdict.changes.some((one) => one.reason === change.verdict.reason) ? "" : reason(change.verdict),
      ].filter(Boolean);
      return h(
        "li",
        {},
        h("button", { type: "button", class: "goal-link", onclick: () => this.handlers.pick(goal.id) }, goalName(goal.id)),
        h("span", { class: "sub" }, goal.directive),
        h("span", {}, bits.join(" · ")),
      );
    };
    this.pages.changes.replaceChildren(
      ...(before ? [] : [h("p", { class: "note" }, "The first decision: everything is new.")]),
      ...kinds.flatMap((kind) => {
        const these = changed.filter((change) => change.kind === kind);
        return [h("h3", {}, `${CHANGE_WORDS[kind]} `, h("span", { class: "count" }, these.length)), h("ul", { class: "changes" }, these.map(line))];
      }),
      ...(changed.length === 0 ? [h("p", { class: "note" }, "Nothing changed about any goal.")] : []),
    );
  }

  private plans(moment: Moment): void {
    const { view } = this.store;
    const svg = familyPlot(moment, view.option, { point: this.handlers.option });
    const proof =
      moment.proof === "proven"
        ? `Proven: no better sequence of the ${moment.shortlist} goals searched (${moment.expansions} labels).`
        : `The search was cut after ${moment.expansions} labels${moment.bound === undefined ? "" : `; no sequence is worth more than ${plain(moment.bound)}`}.`;
    const rows = moment.family.map((one, index) =>
      h(
        "tr",
        {
          tabindex: 0,
          class: `${index === moment.chosen ? "chosen" : ""} ${index === view.option ? "picked" : ""}`,
          onpointerenter: () => this.handlers.option(index),
          onpointerleave: () => this.handlers.option(undefined),
          onfocus: () => this.handlers.option(index),
          "data-option": index,
        },
        h("td", { class: "number" }, plain(one.value)),
        h("td", { class: "number" }, chance(one.reliability)),
        h("td", { class: "number" }, clock(one.timeS)),
        h("td", { class: "number" }, energy(one.energyJ)),
        h("td", { class: "order" }, index === moment.chosen ? h("b", {}, "chosen ") : "", orderOf(one)),
      ),
    );
    const kept = this.pages.plans.querySelector<HTMLElement>(".plans")?.dataset.decision;
    // Pointing at a member must not rebuild what is pointed at.
    if (kept === String(moment.number)) {
      for (const one of this.pages.plans.querySelectorAll<Element>("[data-option]")) {
        one.classList.toggle("picked", one.getAttribute("data-option") === String(view.option));
      }
      return;
    }
    this.pages.plans.replaceChildren(
      h(
        "div",
        { class: "plans", "data-decision": moment.number },
        h("p", { class: "note" }, proof, " Size is energy; on the map a plan's way is broken where only its poses are known."),
        svg,
        h("p", { class: "tools" }, h("button", { type: "button", onclick: () => saveSvg(`plans-${moment.number}.svg`, svg) }, "Save as SVG")),
        h("p", { class: "sub" }, objectiveLines(moment)),
        h(
          "table",
          { class: "plan-table" },
          h("thead", {}, h("tr", {}, ["value", "reliability", "time", "energy", "order"].map((label) => h("th", {}, label)))),
          h("tbody", {}, rows),
        ),
      ),
    );
  }

  private run(run: Run, moment: Moment): void {
    const { facts } = run;
    const text = h("pre", { class: "attachment", tabindex: 0 });
    const lines = run.lines.filter((line) => line.decision === moment.number);
    const happenings = run.happenings;
    text.hidden = true;
    this.pages.run.replaceChildren(
      h("h3", {}, "The chosen plans over the run"),
      this.trendPlace,
      h("h3", {}, `What was written at decision ${moment.number}`),
      h("ul", { class: "lines" }, lines.map((line) => h("li", { class: line.level >= 3 ? "warning" : "" }, line.text)), lines.length === 0 && h("li", { class: "note" }, "nothing")),
      h("h3", {}, "Known then"),
      h("p", {}, `${(100 * moment.seen).toFixed(1)} % of the ground, background interest ${share(moment.background)}; ${moment.sites} maxima, ${moment.shortlist} goals sequenced. Facts: ${moment.facts.join(", ") || "none"}.`),
      h("h3", {}, "From outside, and faults"),
      h("ul", { class: "lines" }, happenings.map((one) => h("li", {}, `${clock(one.timeS)} ${one.kind}: ${one.text}`)), happenings.length === 0 && h("li", { class: "note" }, "none")),
      h("h3", {}, "Topics in the file"),
      h(
        "table",
        { class: "topics" },
        h("tbody", {}, run.topics.map((topic) => h("tr", { class: topic.known ? "" : "unknown" }, h("td", {}, topic.topic), h("td", {}, topic.schema), h("td", { class: "number" }, topic.count), h("td", { class: "number" }, bytes(topic.bytes)), h("td", {}, topic.known ? "" : "not shown here")))),
      ),
      h("h3", {}, "The run"),
      h("dl", { class: "facts" }, Object.entries({ ...facts.run, ...run.end }).map(([key, value]) => h("div", {}, h("dt", {}, key), h("dd", {}, value || "none")))),
      h("h3", {}, "Files of the mission"),
      h(
        "p",
        { class: "tools" },
        facts.attachments.map(({ name, bytes: size }) =>
          h(
            "button",
            {
              type: "button",
              onclick: async () => {
                text.textContent = (await this.handlers.attachment(name)) ?? "";
                text.hidden = false;
              },
            },
            `${name} (${bytes(size)})`,
          ),
        ),
      ),
      text,
    );
    this.trend.show(run, this.store.view.index);
  }
}

const cells = (count: number): string => `${count} cell${count === 1 ? "" : "s"}`;

const figure = (label: string, value: string): HTMLElement => h("div", {}, h("span", { class: "value" }, value), h("span", { class: "label" }, label));

/** The plot with its colours inside, to stand without this page. */
const saveSvg = (name: string, svg: SVGSVGElement): void => {
  const copy = svg.cloneNode(true) as SVGSVGElement;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  const style = document.createElementNS("http://www.w3.org/2000/svg", "style");
  style.textContent =
    ".grid{stroke:#ddd}.tick,.axis{font:11px sans-serif;fill:#444}.plan{fill:#56b4e9;fill-opacity:.55;stroke:#1f5f86}.plan.chosen{fill:#d55e00;fill-opacity:1;stroke:#111}";
  copy.prepend(style);
  save(name, new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" }));
};
