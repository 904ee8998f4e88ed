// The page: map on the left, decision on the right, timeline below, and one record of what is looked at.

import { Address } from "./page/address";
import { Ground } from "./page/ground";
import { Intake } from "./page/intake";
import { listenKeys } from "./page/keys";
import type { Keys } from "./page/keys";
import { Layers } from "./page/layers";
import { Player } from "./page/player";
import { Readout } from "./page/readout";
import { Side } from "./page/side";
import type { Sides } from "./page/side";
import { applyTheme, keptTheme, nextTheme } from "./page/theme";
import { BETWEEN } from "./planes";
import type { Origin, Tell } from "./read/protocol";
import { Store } from "./state";
import type { Tab, View } from "./state";
import { h, save } from "./ui/dom";
import { Header } from "./ui/header";
import { helpDialog } from "./ui/help";
import { Banner, Hint } from "./ui/notices";
import { Panel } from "./ui/panel";
import { TimelineView } from "./view/timeline";

const TABS: readonly Tab[] = ["goals", "changes", "plans", "run", "other"];

export class App {
  private readonly store = new Store();
  private readonly sides: Sides = { a: undefined, b: undefined };
  private readonly layers = new Layers(this.store, this.sides);
  private readonly readout = new Readout(this.sides);
  private readonly player = new Player(this.store, this.sides);
  private readonly banner = new Banner();
  private readonly hint = new Hint();
  private readonly help = helpDialog();
  private readonly intake = new Intake((files, beside) => this.take(files, beside));
  private readonly address = new Address(() => this.followAddress());
  private readonly header = new Header({
    png: () => this.savePng(),
    csv: () => this.saveCsv(),
    open: () => this.intake.choose(false),
    compare: () => this.intake.choose(true),
    theme: () => this.swapTheme(),
    help: () => this.help.showModal(),
  });
  private readonly ground = new Ground(this.store, this.sides, {
    probe: (probe) => {
      const was = this.store.view.probe;
      if (was?.row !== probe?.row || was?.col !== probe?.col) this.store.set({ probe });
    },
    wipe: (wipe) => this.store.set({ wipe }),
    pick: (goal) => this.store.set({ goal, ...(goal === undefined ? {} : { tab: "goals" as const }) }),
  });
  private readonly timeline = new TimelineView(h("canvas", { class: "lanes", tabindex: 0, "aria-label": "Timeline of decisions, events and goals" }), {
    seek: (index) => this.player.seek(index),
    pick: (goal) => this.store.set({ goal }),
    hint: (text, x, y) => this.hint.show(text, x, y),
  });
  private readonly panel = new Panel(h("aside", { "aria-label": "Decision" }), this.store, {
    step: (by) => this.player.seek(this.store.view.index + by),
    seek: (index) => this.player.seek(index),
    part: (index) => {
      this.store.set({ axis: "decision" });
      this.player.seek(index);
    },
    close: () => this.closeOther(),
    pick: (goal) => this.store.set({ goal }),
    option: (option) => this.store.set({ option }),
    attachment: (name) => this.sides.a?.client.attachment(name) ?? Promise.resolve(undefined),
  });
  private readonly axisButton = h("button", { type: "button", title: "Axis of the timeline (t)", onclick: () => this.swapAxis() });
  private readonly main: HTMLElement;

  constructor(root: HTMLElement) {
    this.main = h("main", { hidden: true }, this.mapPane(), this.panel.element, this.timePane());
    root.append(this.header.element, this.banner.element, this.main, this.intake.welcome, this.hint.element, this.intake.file);
    this.store.listen((changed) => this.update(changed));
    listenKeys(() => this.keys());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    this.store.view.theme = keptTheme();
    applyTheme(this.store.view.theme);
    this.axisLabel();
  }

  /** Opens a log in place of the one that is open. */
  open(origin: Origin): void {
    this.closeOther();
    this.sides.a?.close();
    this.intake.welcome.hidden = true;
    this.banner.say("", "");
    delete document.documentElement.dataset.ready;
    delete document.documentElement.dataset.drawn;
    this.sides.a = new Side(origin, (side, tell) => this.hear(side, tell));
  }

  /** Opens a log beside the one that is open. */
  compare(origin: Origin): void {
    this.closeOther();
    this.sides.b = new Side(origin, (side, tell) => this.hearOther(side, tell));
  }

  private closeOther(): void {
    this.sides.b?.close();
    this.sides.b = undefined;
    delete document.documentElement.dataset.other;
    const { view } = this.store;
    this.store.set({ tab: view.tab === "other" ? "goals" : view.tab, layer: view.layer === BETWEEN ? "map:interest" : view.layer });
    this.layers.offer();
    this.headline();
    this.store.grown();
  }

  /** One file is opened; of two the second beside the first. */
  private take(files: readonly File[], beside: boolean): void {
    const [first, second] = files.map((file): Origin => ({ kind: "blob", name: file.name, blob: file }));
    if (!first) return;
    if (beside && this.sides.a?.run) this.compare(first);
    else this.open(first);
    if (second) this.compare(second);
  }

  private hear({ run }: Side, tell: Tell): void {
    if (tell.kind === "failed") this.banner.say("damaged", tell.text);
    if (run && tell.kind === "facts") {
      this.main.hidden = false;
      this.store.set({ index: 0, goal: undefined, option: undefined, probe: undefined });
      this.headline();
    }
    if (run && tell.kind === "batch") {
      this.layers.offer();
      this.header.progress(run);
      this.followAddress();
    }
    if (run && tell.kind === "end") {
      this.layers.offer();
      this.headline();
      const { wholeness } = tell;
      const fault = "text" in wholeness ? wholeness.text : "";
      if (run.moments.length === 0) this.banner.say("damaged", `${run.facts.name} holds no decision. ${fault}`);
      else this.banner.say(wholeness.kind, fault);
      document.documentElement.dataset.ready = "true";
    }
    this.store.grown();
  }

  private hearOther({ run }: Side, tell: Tell): void {
    if (tell.kind === "failed") this.banner.say("damaged", `B: ${tell.text}`);
    if (run && tell.kind === "end") {
      if ("text" in tell.wholeness) this.banner.say(tell.wholeness.kind, `B: ${tell.wholeness.text}`);
      this.layers.offer();
      this.store.set({ tab: "other" });
      this.headline();
      document.documentElement.dataset.other = "true";
    }
    this.store.grown();
  }

  private update(changed: ReadonlySet<keyof View | "log">): void {
    const { a, b } = this.sides;
    const { view } = this.store;
    const touched = (...keys: (keyof View | "log")[]): boolean => keys.some((key) => changed.has(key));
    if (touched("theme")) {
      applyTheme(view.theme);
      this.redraw();
    }
    const run = a?.run;
    const moment = run?.moment(view.index);
    if (moment) b?.follow(view.index, moment.timeS, view.axis);
    if (!run || run.moments.length === 0) return;
    if (moment && touched("index")) this.address.write(moment.number);
    // Before it is drawn in: a canvas out of sight has no size.
    if (touched("solid")) this.ground.swap();
    if (touched("index", "layer", "log", "colours", "shaded", "solid", "axis")) void this.ground.show();
    else this.ground.draw();
    if (touched("index", "goal", "axis", "log", "theme")) this.timeline.show({ run, index: view.index, axis: view.axis, goal: view.goal });
    if (touched("index", "goal", "tab", "option", "axis") || (touched("log") && this.panelIsOld())) this.panel.show(run, b?.run && { run: b.run, index: b.index });
    if (touched("probe", "index")) this.readout.show(view);
    if (touched("axis")) this.axisLabel();
    if (touched("playing")) this.player.show();
    this.layers.element.value = view.layer;
  }

  /** While a log comes in, what the panel shows seldom changes: the count of decisions, and the end. */
  private panelIsOld(): boolean {
    const { a, b } = this.sides;
    const now = `${a?.run?.moments.length}${a?.run?.wholeness.kind}${b?.run?.moments.length}`;
    const old = this.panel.element.dataset.shown !== now;
    this.panel.element.dataset.shown = now;
    return old;
  }

  private mapPane(): HTMLElement {
    const { ground, layers, store } = this;
    return h(
      "section",
      { class: "map-pane", "aria-label": "Map" },
      ground.mapCanvas,
      ground.solidCanvas,
      h(
        "div",
        { class: "map-tools" },
        layers.element,
        layers.colours,
        h("button", { type: "button", title: "Relief (s)", onclick: () => store.set({ shaded: !store.view.shaded }) }, "relief"),
        ground.solidButton,
      ),
      h(
        "div",
        { class: "zoom-tools" },
        h("button", { type: "button", title: "Zoom in (+)", "aria-label": "Zoom in", onclick: () => ground.zoom(1.25) }, "+"),
        h("button", { type: "button", title: "Zoom out (−)", "aria-label": "Zoom out", onclick: () => ground.zoom(0.8) }, "−"),
        h("button", { type: "button", title: "Whole map (0)", "aria-label": "Whole map", onclick: () => ground.fit() }, "⤢"),
      ),
      this.readout.element,
      ground.legend.element,
    );
  }

  private timePane(): HTMLElement {
    return h(
      "section",
      { class: "time-pane", "aria-label": "Timeline" },
      this.timeline.canvas,
      h("div", { class: "time-tools" }, this.player.button, this.axisButton),
    );
  }

  private headline(): void {
    const { a, b } = this.sides;
    if (a?.run) this.header.show(a.run, b?.run);
  }

  private followAddress(): void {
    const run = this.sides.a?.run;
    const index = run && this.address.found(run);
    if (index !== undefined) this.player.seek(index);
  }

  private swapAxis(): void {
    this.store.set({ axis: this.store.view.axis === "time" ? "decision" : "time" });
  }

  private axisLabel(): void {
    this.axisButton.textContent = this.store.view.axis === "time" ? "by time" : "by decision";
  }

  private swapTheme(): void {
    this.store.set({ theme: nextTheme(this.store.view.theme) });
  }

  private redraw(): void {
    this.ground.redraw();
    this.timeline.redraw();
  }

  private keys(): Keys {
    const { store, player, ground, layers } = this;
    const { view } = store;
    const tabs = TABS.filter((tab) => tab !== "other" || this.sides.b).map((tab, i) => [String(i + 1), () => store.set({ tab })] as const);
    return {
      ...Object.fromEntries(tabs),
      ArrowLeft: () => player.seek(view.index - 1),
      ArrowRight: () => player.seek(view.index + 1),
      Home: () => player.seek(0),
      End: () => player.seek(Number.MAX_SAFE_INTEGER),
      " ": () => player.play(!view.playing),
      "?": () => this.help.showModal(),
      g: () => this.focusGoals(),
      "/": () => this.focusGoals("input"),
      m: () => ground.canvas.focus(),
      t: () => this.swapAxis(),
      v: () => store.set({ solid: !view.solid }),
      s: () => store.set({ shaded: !view.shaded }),
      d: () => this.swapTheme(),
      o: () => this.intake.choose(false),
      c: () => this.intake.choose(true),
      "[": () => store.set({ wipe: Math.max(0, view.wipe - 0.05) }),
      "]": () => store.set({ wipe: Math.min(1, view.wipe + 0.05) }),
      l: () => layers.next(1),
      L: () => layers.next(-1),
      Escape: () => store.set({ goal: undefined, probe: undefined }),
    };
  }

  private focusGoals(what?: string): void {
    const focus = (): void => {
      if (what) this.panel.goals.element.querySelector<HTMLElement>(what)?.focus();
      else this.panel.goals.focus();
    };
    // At once where the table is in sight: the next key must find it.
    if (this.store.view.tab === "goals") return focus();
    this.store.set({ tab: "goals" });
    requestAnimationFrame(focus);
  }

  private savePng(): void {
    const run = this.sides.a?.run;
    const name = `${run?.facts.run.mission ?? "map"}-${run?.moment(this.store.view.index)?.number ?? 0}.png`;
    this.ground.canvas.toBlob((blob) => blob && save(name, blob));
  }

  private saveCsv(): void {
    const run = this.sides.a?.run;
    const { view } = this.store;
    const moment = run?.moment(view.index);
    if (!run || !moment) return;
    this.panel.goals.show(moment, run.moment(view.index - 1), run.facts, view.goal);
    save(`goals-${moment.number}.csv`, new Blob([this.panel.goals.csv()], { type: "text/csv" }));
  }
}
