// The page: map on the left, decision on the right, timeline below, and one record of what is looked at.

import { saveCsv, savePng, saveSvg } from "./page/exports";
import { Growth } from "./page/growth";
import { Ground } from "./page/ground";
import { Intake } from "./page/intake";
import { listenKeys } from "./page/keys";
import type { Keys } from "./page/keys";
import { Layers } from "./page/layers";
import { follow, leadOf, turnTo } from "./page/lead";
import { Links } from "./page/links";
import { MapPane } from "./page/map-pane";
import { Player } from "./page/player";
import { paperOf } from "./page/paper";
import { listenPrint } from "./page/print";
import { PriceTags } from "./page/prices";
import { Readout } from "./page/readout";
import { Side } from "./page/side";
import type { Sides } from "./page/side";
import { TimePane } from "./page/time-pane";
import { applyTheme, keptTheme, nextTheme } from "./page/theme";
import type { Given } from "./given";
import type { Tell } from "./read/protocol";
import { nextTurn } from "./model/changes";
import { Store } from "./state";
import type { Tab, View } from "./state";
import { h } from "./ui/dom";
import { Header } from "./ui/header";
import { helpDialog } from "./ui/help";
import { Banner, Hint, Toast } from "./ui/notices";
import { Panel } from "./ui/panel";

const TABS: readonly Tab[] = ["goals", "changes", "plans", "run", "other"];

export class App {
  private readonly store = new Store();
  private readonly sides: Sides = { a: undefined, b: undefined };
  private readonly layers = new Layers(this.store, this.sides);
  private readonly readout = new Readout(this.sides, this.layers);
  private readonly prices = new PriceTags(this.store, this.sides);
  private readonly player = new Player(this.store, this.sides);
  private readonly banner = new Banner();
  private readonly hint = new Hint();
  private readonly help = helpDialog();
  private readonly intake = new Intake((files, beside) => this.take(files, beside));
  private readonly links = new Links(this.store, this.sides, this.layers, (index) => this.player.seek(index));
  private readonly header = new Header({
    png: () => savePng(this.store.view, this.sides, this.ground),
    svg: () => saveSvg(this.store.view, this.sides, this.ground),
    csv: () => saveCsv(this.store.view, this.sides, this.panel.goals),
    open: () => this.intake.choose(false),
    compare: () => this.intake.choose(true),
    theme: () => this.swapTheme(),
    help: () => this.help.showModal(),
  });
  private readonly ground = new Ground(
    this.store,
    this.sides,
    this.layers,
    {
      probe: (probe, probed) => {
        const was = this.store.view;
        if (was.probe?.row !== probe?.row || was.probe?.col !== probe?.col || was.probed !== probed) this.store.set({ probe, probed });
      },
      wipe: (wipe) => this.store.set({ wipe }),
      pick: (goal, of) => {
        if (goal !== undefined) turnTo(this.store, this.sides, of);
        this.store.set({ goal, ...(goal === undefined ? {} : { tab: "goals" as const }) });
      },
    },
    () => this.mapPane.noSolid(),
  );
  private readonly mapPane = new MapPane(this.store, this.sides, this.ground, this.layers, this.readout);
  private readonly time = new TimePane(this.store, this.sides, this.player, {
    seek: (index, of) => {
      turnTo(this.store, this.sides, of);
      this.player.seek(index);
    },
    pick: (goal, of) => {
      turnTo(this.store, this.sides, of);
      this.store.set({ goal });
    },
    hint: (text, x, y) => this.hint.show(text, x, y),
  });
  private readonly panel = new Panel(h("aside", { "aria-label": "Decision" }), this.store, {
    step: (by) => this.player.seek(this.store.view.index + by),
    seek: (index) => this.player.seek(index),
    part: (index) => this.part(index),
    close: () => this.closeOther(),
    pick: (goal) => this.store.set({ goal }),
    option: (option) => this.store.set({ option }),
    price: (goal, decision) => this.prices.tag(goal, decision),
    turn: (subject) => turnTo(this.store, this.sides, subject),
    attachment: (name) => leadOf(this.sides, this.store.view)?.client.attachment(name) ?? Promise.resolve(undefined),
  });
  private readonly growth = new Growth(this.sides, this.layers);
  private readonly toast = new Toast();
  private readonly main: HTMLElement;

  constructor(root: HTMLElement) {
    this.mapPane.dock = this.panel.element;
    this.main = h("main", { hidden: true }, this.mapPane.element, this.panel.element, this.time.element);
    root.append(this.header.element, this.banner.element, this.main, this.intake.welcome, this.hint.element, this.toast.element, this.intake.file);
    this.store.listen((changed) => this.update(changed));
    listenKeys(() => this.keys());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    this.store.view.theme = keptTheme();
    applyTheme(this.store.view.theme);
    listenPrint(() => paperOf(this.sides, this.header.facts, this.ground, this.panel, this.time), (on) => applyTheme(on ? "light" : this.store.view.theme));
  }

  /** Opens a log in place of the one that is open. */
  open(given: Given): void {
    this.closeOther();
    this.sides.a?.close();
    this.intake.welcome.hidden = true;
    this.banner.say("a", "", "");
    delete document.documentElement.dataset.ready;
    delete document.documentElement.dataset.drawn;
    this.sides.a = new Side(given, (side, tell) => this.hear(side, tell), () => this.learned());
  }

  /** Opens a log beside the one that is open. */
  compare(given: Given): void {
    this.closeOther();
    this.banner.beside(true);
    this.sides.b = new Side(given, (side, tell) => this.hearOther(side, tell), () => this.learned());
  }

  private closeOther(): void {
    this.sides.b?.close();
    if (this.sides.b && this.store.view.subject === "b") turnTo(this.store, this.sides, "a");
    this.sides.b = undefined;
    this.banner.beside(false);
    delete document.documentElement.dataset.other;
    const { view } = this.store;
    this.store.set({ tab: view.tab === "other" ? "goals" : view.tab, probed: "a" });
    this.timeSize();
    this.layers.offer();
    this.headline();
    this.store.grown();
  }

  /** One file is opened; of two the second beside the first. */
  private take(files: readonly File[], beside: boolean): void {
    const [first, second] = files.map((file): Given => ({ origin: { kind: "blob", name: file.name, blob: file }, supply: { kind: "none" } }));
    if (!first) return;
    if (beside && this.sides.a?.run) this.compare(first);
    else this.open(first);
    if (second) this.compare(second);
  }

  /** What can be derived has become known. */
  private learned(): void {
    this.layers.offer();
    this.links.follow();
    this.store.grown();
  }

  private hear({ run }: Side, tell: Tell): void {
    if (tell.kind === "failed") this.failed(tell.text);
    if (run && tell.kind === "facts") {
      this.main.hidden = false;
      this.main.classList.remove("empty");
      this.store.set({ index: 0, goal: undefined, option: undefined, probe: undefined });
      this.headline();
    }
    if (run && tell.kind === "batch") {
      this.layers.offer();
      this.header.progress(run);
      this.links.follow();
    }
    if (run && tell.kind === "end") {
      this.layers.offer();
      this.headline();
      this.links.follow();
      const { wholeness } = tell;
      const fault = "text" in wholeness ? wholeness.text : "";
      this.main.classList.toggle("empty", run.moments.length === 0);
      if (run.moments.length === 0) this.banner.say("a", wholeness.kind === "whole" ? "unfinished" : wholeness.kind, `${run.facts.name}: no decision is to be had. ${fault || "What the file holds is listed below."}`);
      else this.banner.say("a", wholeness.kind, fault);
      document.documentElement.dataset.ready = "true";
    }
    this.store.grown();
  }

  /** What could not even be begun: there is nothing to show but why. */
  private failed(text: string): void {
    this.banner.say("a", "damaged", text);
    this.intake.welcome.hidden = this.sides.a?.run !== undefined;
    document.documentElement.dataset.ready = "true";
  }

  private hearOther({ run }: Side, tell: Tell): void {
    if (tell.kind === "failed") this.banner.say("b", "damaged", tell.text);
    if (run && tell.kind === "end") {
      if ("text" in tell.wholeness) this.banner.say("b", tell.wholeness.kind, tell.wholeness.text);
      this.layers.offer();
      if (!this.links.tab) this.store.set({ tab: "other" });
      this.headline();
      document.documentElement.dataset.other = "true";
      this.timeSize();
      this.links.follow();
      this.openWipe();
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
    follow(this.sides, view, touched("axis", "log"));
    if (!run) return;
    if (run.moments.length === 0) {
      if (touched("log")) this.panel.show({ run, index: 0 }, undefined);
      return;
    }
    this.links.write();
    const grown = touched("log") && this.growth.news();
    if (touched("index", "layer", "aspect", "colours", "shaded", "axis", "subject") || grown) void this.ground.show();
    else if (changed.size > 1 || !touched("log")) this.ground.draw();
    this.mapPane.show(view);
    if (touched("index", "goal", "axis", "theme", "subject") || (touched("log") && this.growth.due())) this.time.show(run);
    if (touched("index", "goal", "tab", "option", "axis", "subject") || grown) this.panel.show({ run, index: a.index }, b?.run && { run: b.run, index: b.index });
    else if (touched("log")) this.panel.count(leadOf(this.sides, view)?.run ?? run);
    this.readout.show(view);
    if (touched("playing", "pace", "loop")) this.player.show();
    this.layers.show();
  }

  private headline(): void {
    const { a, b } = this.sides;
    if (a?.run) this.header.show(a.run, b?.run);
  }

  /** To the first decision that the two runs took otherwise. */
  private part(index: number): void {
    this.store.set({ axis: "decision", tab: "other" });
    this.player.seek(index);
  }

  private firstDivergence(): void {
    const { a, b } = this.sides;
    const first = a?.run && b?.run && this.panel.other.firstDivergence(a.run, b.run);
    if (first !== undefined) this.part(first);
    else if (b) this.toast.say("The runs choose alike throughout.");
  }

  private nextTurn(by: 1 | -1): void {
    const next = nextTurn(leadOf(this.sides, this.store.view)?.run?.moments ?? [], this.store.view.index, by);
    if (next !== undefined) this.player.seek(next);
    else this.toast.say(`No goal is added or dropped ${by > 0 ? "after" : "before"} this decision.`);
  }

  /** Two runs need more room for their lanes. */
  private timeSize(): void {
    this.main.classList.toggle("two", this.sides.b !== undefined);
  }

  /** The wipe begins where it hides neither rover nor next goal: once the map has its new size. */
  private openWipe(): void {
    const { view } = this.store;
    const was = view.wipe;
    requestAnimationFrame(() => requestAnimationFrame(() => view.wipe === was && this.store.set({ wipe: this.ground.freeWipe() })));
  }

  private swapTheme(): void {
    this.store.set({ theme: nextTheme(this.store.view.theme) });
  }

  private redraw(): void {
    this.ground.redraw();
    this.time.redraw();
  }

  private keys(): Keys {
    const { store, player, ground, layers } = this;
    const { view } = store;
    const tabs = TABS.filter((tab) => tab !== "other" || this.sides.b).map((tab, i) => [String(i + 1), () => store.set({ tab })] as const);
    return {
      ...Object.fromEntries(tabs),
      ArrowLeft: () => player.seek(view.index - 1),
      ArrowRight: () => player.seek(view.index + 1),
      n: () => this.nextTurn(1),
      N: () => this.nextTurn(-1),
      Home: () => player.seek(0),
      End: () => player.seek(Number.MAX_SAFE_INTEGER),
      " ": () => player.play(!view.playing),
      "?": () => this.help.showModal(),
      g: () => this.focusGoals(),
      "/": () => this.focusGoals("input"),
      m: () => ground.canvas.focus(),
      t: () => this.time.swapAxis(),
      v: () => store.set({ solid: !view.solid }),
      h: ground.solid ? () => this.mapPane.nextHeights() : undefined,
      s: () => store.set({ shaded: !view.shaded }),
      w: () => store.set({ alternatives: !view.alternatives }),
      a: () => layers.nextAspect(),
      b: this.sides.b ? () => this.mapPane.modes.next() : undefined,
      x: this.sides.b ? () => turnTo(store, this.sides, view.subject === "a" ? "b" : "a") : undefined,
      f: this.sides.b ? () => this.firstDivergence() : undefined,
      ",": () => player.hurry(-1),
      ".": () => player.hurry(1),
      r: () => player.loop(),
      y: () => void this.links.copy().then((words) => this.toast.say(words)),
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
    const there = this.store.view.tab === "goals";
    this.store.set({ tab: "goals" });
    // A page that is not in sight yet takes no focus.
    if (there) focus();
    else requestAnimationFrame(focus);
  }
}
