// The page: map on the left, decision on the right, timeline below, and one record of what is looked at.

import { difference, range } from "./model/plane";
import type { Plane } from "./model/plane";
import { Run } from "./model/run";
import type { Cell, PlaneName } from "./model/types";
import { BETWEEN, DIFFERENCE, Planes } from "./planes";
import { LogClient } from "./read/client";
import type { Origin, Tell } from "./read/protocol";
import { Store } from "./state";
import type { Tab, Theme, View } from "./state";
import { h, save } from "./ui/dom";
import { bytes, goalName, place, plain } from "./ui/format";
import { helpDialog } from "./ui/help";
import { Panel } from "./ui/panel";
import { at } from "./model/plane";
import { colourTable, css } from "./view/colour";
import { MapView } from "./view/map";
import type { Scale } from "./view/paint";
import type { Relief } from "./view/relief";
import { SolidView } from "./view/solid";
import { TimelineView } from "./view/timeline";

/** A second run and what of it is shown. */
interface Other {
  client: LogClient;
  planes: Planes;
  run: Run | undefined;
  index: number;
  plane: Plane | undefined;
  relief: Relief | undefined;
}

const THEMES: readonly Theme[] = ["auto", "light", "dark"];
const TABS: readonly Tab[] = ["goals", "changes", "plans", "run", "other"];
const COLOURS: readonly View["colours"][] = ["viridis", "cividis", "batlow"];

export class App {
  private readonly store = new Store();
  /** The second run, if one is open. */
  private other: Other | undefined;
  private client: LogClient | undefined;
  private planes: Planes | undefined;
  private run: Run | undefined;
  private relief: Relief | undefined;
  private lighting: Promise<Relief | undefined> | undefined;
  private elevation: Plane | undefined;
  private solidView: SolidView | undefined;
  private plane: Plane | undefined;
  private scale: Scale = { colours: "viridis", min: 0, max: 1 };
  private timer: number | undefined;
  /** The decision that the address asks for, until it was read. */
  private wanted: number | undefined;
  private readonly help = helpDialog();
  /** Whether the file being chosen is to be the second. */
  private beside = false;

  private readonly banner = h("div", { class: "banner", role: "status" });
  private readonly facts = h("div", { class: "facts-line" });
  private readonly mapCanvas = h("canvas", { class: "map", tabindex: 0, "aria-label": "Map. Keys: + − 0, Shift and arrows, Alt and arrows" });
  private readonly timeCanvas = h("canvas", { class: "lanes", tabindex: 0, "aria-label": "Timeline of decisions, events and goals" });
  private readonly layers = h("select", { "aria-label": "Layer", title: "Layer (l)" });
  private readonly colours = h("select", { "aria-label": "Colours" }, COLOURS.map((name) => h("option", { value: name }, name)));
  private readonly legend = h("div", { class: "legend" });
  private readonly readout = h("div", { class: "readout" });
  private readonly hint = h("div", { class: "hint", role: "tooltip" });
  private readonly playButton = h("button", { type: "button", class: "play", title: "Play (Space)", onclick: () => this.play(!this.store.view.playing) }, "▶");
  private readonly solidButton = h("button", { type: "button", title: "Ground in three dimensions (v)", "aria-pressed": "false", onclick: () => this.store.set({ solid: !this.store.view.solid }) }, "3-D");
  private readonly solidCanvas = h("canvas", { class: "solid", tabindex: 0, hidden: true, "aria-label": "The ground in three dimensions" });
  private readonly axisButton = h("button", { type: "button", title: "Axis of the timeline (t)", onclick: () => this.swapAxis() });
  private readonly file = h("input", { type: "file", accept: ".mcap,.part", multiple: true, hidden: true, "aria-hidden": "true" });
  private readonly welcome = h("div", { class: "welcome" });
  private readonly main = h("main");
  private readonly panel: Panel;
  private readonly map: MapView;
  private readonly timeline: TimelineView;

  constructor(root: HTMLElement) {
    const aside = h("aside", { "aria-label": "Decision" });
    this.main.append(
      h(
        "section",
        { class: "map-pane", "aria-label": "Map" },
        this.mapCanvas,
        this.solidCanvas,
        h(
          "div",
          { class: "map-tools" },
          this.layers,
          this.colours,
          h("button", { type: "button", title: "Relief (s)", onclick: () => this.store.set({ shaded: !this.store.view.shaded }) }, "relief"),
          this.solidButton,
        ),
        h(
          "div",
          { class: "zoom-tools" },
          h("button", { type: "button", title: "Zoom in (+)", "aria-label": "Zoom in", onclick: () => this.zoom(1.25) }, "+"),
          h("button", { type: "button", title: "Zoom out (−)", "aria-label": "Zoom out", onclick: () => this.zoom(0.8) }, "−"),
          h("button", { type: "button", title: "Whole map (0)", "aria-label": "Whole map", onclick: () => this.showAll() }, "⤢"),
        ),
        this.readout,
        this.legend,
      ),
      aside,
      h(
        "section",
        { class: "time-pane", "aria-label": "Timeline" },
        this.timeCanvas,
        h("div", { class: "time-tools" }, this.playButton, this.axisButton),
      ),
    );
    root.append(
      h(
        "header",
        {},
        h("h1", {}, "Wisdom"),
        this.facts,
        h(
          "div",
          { class: "actions" },
          h("button", { type: "button", title: "Save the map as PNG", onclick: () => this.savePng() }, "PNG"),
          h("button", { type: "button", title: "Goals of this decision as CSV", onclick: () => this.saveCsv() }, "CSV"),
          h("button", { type: "button", title: "Open a log (o)", onclick: () => this.choose(false) }, "Open…"),
          h("button", { type: "button", title: "Open a second log beside this one (c), or drop it with Shift", onclick: () => this.choose(true) }, "Compare…"),
          h("button", { type: "button", title: "Light or dark (d)", "aria-label": "Light or dark", onclick: () => this.swapTheme() }, "◐"),
          h("button", { type: "button", title: "Keys (?)", "aria-label": "Keys", onclick: () => this.help.showModal() }, "?"),
        ),
      ),
      this.banner,
      this.main,
      this.welcome,
      this.hint,
      this.file,
    );
    this.welcome.append(
      h("h2", {}, "No log is open"),
      h("p", {}, "Drop an .mcap file anywhere on this page, or ", h("button", { type: "button", onclick: () => this.choose(false) }, "choose one"), "."),
      h("p", { class: "note" }, "It is read here, in this page. Nothing is sent anywhere. Files that were cut short or damaged are read up to the fault."),
    );
    this.panel = new Panel(aside, this.store, {
      step: (by) => this.seek(this.store.view.index + by),
      seek: (index) => this.seek(index),
      part: (index) => {
        this.store.set({ axis: "decision" });
        this.seek(index);
      },
      close: () => this.closeOther(),
      pick: (goal) => this.store.set({ goal }),
      option: (option) => this.store.set({ option }),
      attachment: (name) => this.client?.attachment(name) ?? Promise.resolve(undefined),
    });
    this.map = new MapView(this.mapCanvas, {
      probe: (probe) => {
        const was = this.store.view.probe;
        if (was?.row !== probe?.row || was?.col !== probe?.col) this.store.set({ probe });
      },
      wipe: (wipe) => this.store.set({ wipe }),
      pick: (goal) => this.store.set({ goal, ...(goal === undefined ? {} : { tab: "goals" as const }) }),
    });
    this.timeline = new TimelineView(this.timeCanvas, {
      seek: (index) => this.seek(index),
      pick: (goal) => this.store.set({ goal }),
      hint: (text, x, y) => this.showHint(text, x, y),
    });
    this.store.listen((changed) => this.update(changed));
    this.listen();
    this.theme(readTheme());
    this.fromHash();
    this.main.hidden = true;
    this.axisLabel();
  }

  /** Opens a log beside the one that is open. */
  compare(origin: Origin): void {
    this.closeOther();
    const client = new LogClient((tell) => {
      if (client === this.other?.client) this.hearOther(tell);
    });
    this.other = { client, planes: new Planes(client), run: undefined, index: 0, plane: undefined, relief: undefined };
    client.open(origin);
  }

  private hearOther(tell: Tell): void {
    const { other } = this;
    if (!other) return;
    if (tell.kind === "facts") other.run = new Run(tell.facts);
    if (tell.kind === "batch") other.run?.add(tell.batch);
    if (tell.kind === "end") {
      if (other.run) other.run.wholeness = tell.wholeness;
      if ("text" in tell.wholeness) this.say(tell.wholeness.kind, `B: ${tell.wholeness.text}`);
      this.offerLayers();
      this.store.set({ tab: "other" });
      this.header();
      document.documentElement.dataset.other = "true";
    }
    if (tell.kind === "failed") this.say("damaged", `B: ${tell.text}`);
    this.store.grown();
  }

  private closeOther(): void {
    this.other?.client.close();
    this.other = undefined;
    delete document.documentElement.dataset.other;
    const { view } = this.store;
    this.store.set({ tab: view.tab === "other" ? "goals" : view.tab, layer: view.layer === BETWEEN ? "map:interest" : view.layer });
    this.offerLayers();
    this.header();
    this.store.grown();
  }

  /** Files that were dropped or chosen: one is opened; of two the second beside the first. */
  private take(files: readonly File[], beside: boolean): void {
    const [first, second] = files.map((file): Origin => ({ kind: "blob", name: file.name, blob: file }));
    if (!first) return;
    if (beside && this.run) this.compare(first);
    else this.open(first);
    if (second) this.compare(second);
  }

  /** The second run's place under the first one's cursor: at the same time, or at the same number. */
  private followCursor(): void {
    const { run, other } = this;
    const moment = run?.moment(this.store.view.index);
    if (!other?.run || !moment) return;
    const last = other.run.moments.length - 1;
    other.index = this.store.view.axis === "time" ? other.run.indexAt(moment.timeS) : Math.min(last, this.store.view.index);
  }

  /** Opens a log in place of the one that is open. */
  open(origin: Origin): void {
    this.closeOther();
    this.client?.close();
    this.run = undefined;
    this.relief = undefined;
    this.elevation = undefined;
    this.lighting = undefined;
    this.plane = undefined;
    this.welcome.hidden = true;
    this.say("", "");
    delete document.documentElement.dataset.ready;
    delete document.documentElement.dataset.drawn;
    const client = new LogClient((tell) => {
      if (client === this.client) this.hear(tell);
    });
    this.client = client;
    this.planes = new Planes(client);
    client.open(origin);
  }

  private hear(tell: Tell): void {
    switch (tell.kind) {
      case "facts":
        this.run = new Run(tell.facts);
        this.main.hidden = false;
        this.store.set({ index: 0, goal: undefined, option: undefined, probe: undefined });
        this.header();
        break;
      case "batch":
        this.run?.add(tell.batch);
        this.offer(tell.planes);
        if (this.run) this.run.readBytes = tell.readBytes;
        this.progress();
        this.followHash();
        break;
      case "end":
        if (!this.run) break;
        this.run.wholeness = tell.wholeness;
        this.run.end = tell.run;
        this.run.topics = tell.topics;
        this.offer(tell.planes);
        this.header();
        if (tell.wholeness.kind === "whole") this.say("", "");
        else if (tell.wholeness.kind !== "reading") this.say(tell.wholeness.kind, tell.wholeness.text);
        if (this.run.moments.length === 0) this.say("damaged", `${this.run.facts.name} holds no decision. ${"text" in tell.wholeness ? tell.wholeness.text : ""}`);
        document.documentElement.dataset.ready = "true";
        break;
      case "failed":
        this.say("damaged", tell.text);
        break;
      default:
        break;
    }
    this.store.grown();
  }

  private offer(planes: PlaneName[]): void {
    const { run } = this;
    if (!run || run.planes.length === planes.length) return;
    run.planes = planes;
    this.offerLayers();
  }

  private offerLayers(): void {
    const planes = this.run?.planes ?? [];
    const all = planes.some(({ id }) => id === "map:interest")
      ? [...planes.slice(0, 1), { id: DIFFERENCE, label: "interest, change since last" }, ...(this.other ? [{ id: BETWEEN, label: "interest, A less B" }] : []), ...planes.slice(1)]
      : planes;
    if (!all.some(({ id }) => id === this.store.view.layer)) this.store.set({ layer: all[0]?.id ?? "" });
    this.layers.replaceChildren(...all.map(({ id, label }) => h("option", { value: id, ...(id === this.store.view.layer ? { selected: true } : {}) }, label)));
  }

  private update(changed: ReadonlySet<keyof View | "log">): void {
    const { run } = this;
    const { view } = this.store;
    if (changed.has("theme")) this.theme(view.theme);
    this.followCursor();
    if (!run || run.moments.length === 0) return;
    if (changed.has("index")) this.toHash();
    // Before it is drawn in: a canvas out of sight has no size.
    if (changed.has("solid")) {
      this.mapCanvas.hidden = view.solid;
      this.solidCanvas.hidden = !view.solid;
      this.solidButton.setAttribute("aria-pressed", String(view.solid));
    }
    if (["index", "layer", "log", "colours", "shaded", "solid", "axis"].some((key) => changed.has(key as keyof View))) void this.ground();
    else this.drawMap();
    if (["index", "goal", "axis", "log", "theme"].some((key) => changed.has(key as keyof View))) {
      this.timeline.show({ run, index: view.index, axis: view.axis, goal: view.goal });
    }
    if (["index", "goal", "tab", "option", "axis"].some((key) => changed.has(key as keyof View)) || (changed.has("log") && this.panelIsOld())) this.panel.show(run, this.other?.run && { run: this.other.run, index: this.other.index });
    if (changed.has("probe") || changed.has("index")) this.ask();
    if (changed.has("axis")) this.axisLabel();
    if (changed.has("playing")) this.playButton.textContent = view.playing ? "❚❚" : "▶";
    this.layers.value = view.layer;
  }

  /** While a log comes in, what the panel shows seldom changes: the count of decisions, and the end. */
  private panelIsOld(): boolean {
    const now = `${this.run?.moments.length}${this.run?.wholeness.kind}${this.other?.run?.moments.length}`;
    const old = this.panel.element.dataset.shown !== now;
    this.panel.element.dataset.shown = now;
    return old;
  }

  /** Gets the plane of the layer, and draws it. */
  private async ground(): Promise<void> {
    const { run, planes } = this;
    const { view } = this.store;
    const { index, layer } = view;
    const moment = run?.moment(index);
    if (!run || !planes || !moment) return;
    this.drawMap();
    const { other } = this;
    const against = other?.run?.moment(other.index);
    const [base, lit, beside, litBeside] = await Promise.all([
      planes.at(layer === BETWEEN ? "map:interest" : layer, moment.number),
      this.relief ? undefined : this.light(moment.number),
      against && other?.planes.at(layer === BETWEEN ? "map:interest" : layer, against.number),
      against && other && !other.relief ? other.client.relief("map:elevation", against.number) : undefined,
    ]);
    // One may have moved on meanwhile.
    if (this.run !== run || view.index !== index || view.layer !== layer) return;
    if (lit) {
      this.relief = lit;
      this.elevation = lit.plane;
    }
    const between = layer === BETWEEN && base && beside;
    const plane = between ? difference(base, beside) : base;
    if (other) {
      // Nothing to wipe where the map is of both.
      other.plane = between ? plane : beside;
      other.relief ??= litBeside;
    }
    this.plane = plane;
    this.scale = scaleOf(layer, plane, view.colours);
    this.drawMap();
    this.drawLegend();
    document.documentElement.dataset.drawn = String(moment.number);
    // What is likely to be wanted next.
    const next = run.moment(index + 1);
    if (next) void planes.at(layer, next.number);
  }

  /** Asked for once: the elevation is logged once. */
  private light(decision: number): Promise<Relief | undefined> {
    this.lighting ??= this.client?.relief("map:elevation", decision).then((found) => {
      // Not in the log, or not yet read: asked again with the next decision.
      if (!found) this.lighting = undefined;
      return found;
    });
    return this.lighting ?? Promise.resolve(undefined);
  }

  private drawMap(): void {
    const { run } = this;
    const { view } = this.store;
    if (!run) return;
    const light = view.shaded ? this.relief : undefined;
    const { other } = this;
    const beside = other?.run && { run: other.run, index: other.index, plane: other.plane, relief: view.shaded ? other.relief : undefined, wipe: view.wipe };
    const scene = { run, index: view.index, plane: this.plane, scale: this.scale, relief: light, goal: view.goal, option: view.option, probe: view.probe, ...(beside ? { other: beside } : {}) };
    if (view.solid && this.elevation) this.solid()?.show({ ...scene, elevation: this.elevation });
    else this.map.show(scene);
  }

  /** The view in three dimensions, made when it is first wanted: it takes a while and a graphics context. */
  private solid(): SolidView | undefined {
    try {
      this.solidView ??= new SolidView(this.solidCanvas);
    } catch {
      this.store.set({ solid: false });
      this.solidButton.disabled = true;
      this.solidButton.title = "This browser has no WebGL";
    }
    return this.solidView;
  }

  private zoom(factor: number): void {
    if (this.store.view.solid) this.solidView?.zoom(factor);
    else this.map.zoom(factor);
  }

  private showAll(): void {
    if (this.store.view.solid) this.solidView?.fit();
    else this.map.fit();
  }

  private drawLegend(): void {
    const { view } = this.store;
    const name = this.run?.planes.find(({ id }) => id === view.layer)?.label ?? (view.layer === DIFFERENCE ? "change of interest" : view.layer === BETWEEN ? "interest of A less that of B" : view.layer);
    if (!this.plane) {
      this.legend.replaceChildren(h("p", {}, view.layer === DIFFERENCE ? "There is no decision before this one." : "The log holds no such map at this decision."));
      return;
    }
    const table = colourTable(this.scale.colours);
    const bar = h("div", { class: "bar" });
    bar.style.background = `linear-gradient(90deg, ${Array.from({ length: 24 }, (_, i) => css(table, i / 23)).join(", ")})`;
    const { min, max } = this.scale;
    const labels = [0, 0.25, 0.5, 0.75, 1].map((part) => h("span", {}, legendLabel(min + part * (max - min), max - min)));
    const heights = view.solid && this.solidView ? `heights × ${plain(this.solidView.heightStretch)}, ` : "";
    const stretch = heights + (view.shaded && this.relief ? `relief × ${this.relief.stretch}, light from the north-west` : "no relief");
    this.legend.replaceChildren(h("p", {}, h("b", {}, name)), bar, h("div", { class: "ticks" }, labels), h("p", { class: "sub" }, stretch), wayKey());
  }

  /** Tells every value at the cell asked about. */
  private ask(): void {
    const { run, planes } = this;
    const { view } = this.store;
    const { probe } = view;
    const moment = run?.moment(view.index);
    if (!run || !planes || !moment || !probe) {
      this.readout.replaceChildren();
      return;
    }
    const { grid } = run.facts;
    const [east, north] = [grid.westM + (probe.col + 0.5) * grid.spacingM, grid.northM - (probe.row + 0.5) * grid.spacingM];
    const goals = [...run.verdictsUpTo(view.index).values()].filter(({ verdict }) => verdict.goal.target.row === probe.row && verdict.goal.target.col === probe.col);
    const lines = run.planes.map(({ id, label }) => {
      const value = h("dd", {}, "…");
      // Each as it comes: some layers are put together from many looks first.
      valueAt(planes, id, moment.number, probe).then(
        (found) => (value.textContent = found === undefined ? "unknown" : plain(found)),
        () => (value.textContent = "not readable"),
      );
      return h("div", { class: id === view.layer ? "on" : "" }, h("dt", {}, label), value);
    });
    this.readout.replaceChildren(
      h("p", {}, h("b", {}, `cell ${place(probe)}`), ` ${east.toFixed(1)} m east, ${north.toFixed(1)} m north`),
      h("dl", {}, lines),
      ...goals.map(({ verdict }) => h("p", {}, `${goalName(verdict.goal.id)} ${verdict.goal.directive}: ${verdict.action}, ${verdict.reason}`)),
    );
  }

  private header(): void {
    const { run } = this;
    if (!run) return;
    const { run: facts, name, bytes: size } = run.facts;
    const fact = (label: string, value: string | undefined): HTMLElement | false =>
      value !== undefined && value !== "" && h("span", { class: "fact", title: value }, h("span", { class: "label" }, label), value);
    const ended = run.end["end.status"];
    const whole = run.wholeness.kind;
    this.facts.replaceChildren(
      ...[
        h("b", { class: "mission" }, facts.mission ?? name),
        h("span", { class: `pill ${whole}` }, whole === "whole" ? `complete, ${ended ?? "ended"}` : whole === "reading" ? "reading …" : whole === "unfinished" ? "did not end" : whole === "cut" ? "cut short" : "damaged"),
        fact("rule", facts.rule),
        fact("policy", facts.policy),
        fact("prize", facts.prize),
        fact("seed", facts.seed),
        fact("wisdom", facts.version),
        fact("file", `${name}, ${bytes(size)}`),
        this.other?.run ? fact("B", this.other.run.facts.name) : false,
        // Last, because it may be long.
        facts.overrides ? fact("overrides", facts.overrides.replaceAll("\n", ", ")) : false,
      ].filter((part): part is HTMLElement => part !== false),
    );
    document.title = `${facts.mission ?? name}: Wisdom replay`;
  }

  /** How far reading is, in the header: a banner that comes and goes would push the map about. */
  private progress(): void {
    const { run } = this;
    const pill = this.facts.querySelector(".pill");
    if (run && pill) pill.textContent = `reading, ${Math.round((100 * run.readBytes) / Math.max(1, run.facts.bytes))} %`;
  }

  private say(kind: string, text: string): void {
    this.banner.className = `banner ${kind}`;
    this.banner.textContent = text;
    this.banner.hidden = text === "";
  }

  private showHint(text: string | undefined, x: number, y: number): void {
    this.hint.hidden = text === undefined;
    if (text === undefined) return;
    this.hint.textContent = text;
    const width = this.hint.offsetWidth;
    this.hint.style.left = `${Math.min(window.innerWidth - width - 8, Math.max(8, x + 12))}px`;
    this.hint.style.top = `${y - 34}px`;
  }

  private seek(index: number): void {
    const last = (this.run?.moments.length ?? 1) - 1;
    this.store.set({ index: Math.max(0, Math.min(last, index)), option: undefined });
  }

  private play(playing: boolean): void {
    window.clearInterval(this.timer);
    const { run } = this;
    if (!run) return;
    if (playing && this.store.view.index >= run.moments.length - 1) this.seek(0);
    this.store.set({ playing });
    if (!playing) return;
    this.timer = window.setInterval(() => {
      if (this.store.view.index >= run.moments.length - 1) this.play(false);
      else this.seek(this.store.view.index + 1);
    }, 1000 / this.store.view.pace);
  }

  private swapAxis(): void {
    this.store.set({ axis: this.store.view.axis === "time" ? "decision" : "time" });
  }

  private axisLabel(): void {
    this.axisButton.textContent = this.store.view.axis === "time" ? "by time" : "by decision";
  }

  private swapTheme(): void {
    const next = THEMES[(THEMES.indexOf(this.store.view.theme) + 1) % THEMES.length] ?? "auto";
    this.store.set({ theme: next });
    this.theme(next);
  }

  private theme(theme: Theme): void {
    this.store.view.theme = theme;
    if (theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
    try {
      localStorage.setItem("wisdom-theme", theme);
    } catch {
      // A page opened from disk may have no storage; the theme then lasts as long as the page.
    }
    this.map?.redraw();
    this.timeline?.redraw();
  }

  private fromHash(): void {
    const found = /(?:^#|&)d=(\d+)/.exec(location.hash)?.[1];
    this.wanted = found === undefined ? undefined : Number(found);
  }

  private followHash(): void {
    if (this.wanted === undefined || !this.run) return;
    const index = this.run.moments.findIndex((moment) => moment.number === this.wanted);
    if (index < 0) return;
    this.wanted = undefined;
    this.seek(index);
  }

  private toHash(): void {
    if (this.wanted !== undefined) return;
    const number = this.run?.moment(this.store.view.index)?.number ?? 0;
    if (location.hash !== `#d=${number}`) history.replaceState(null, "", `#d=${number}`);
  }

  private listen(): void {
    this.layers.addEventListener("change", () => this.store.set({ layer: this.layers.value }));
    this.colours.addEventListener("change", () => this.store.set({ colours: this.colours.value as View["colours"] }));
    this.file.addEventListener("change", () => {
      this.take([...(this.file.files ?? [])], this.beside);
      this.beside = false;
      this.file.value = "";
    });
    document.addEventListener("dragover", (event) => {
      event.preventDefault();
      document.documentElement.classList.add("dropping");
    });
    document.addEventListener("dragleave", (event) => {
      if (event.relatedTarget === null) document.documentElement.classList.remove("dropping");
    });
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      document.documentElement.classList.remove("dropping");
      this.take([...(event.dataTransfer?.files ?? [])], event.shiftKey);
    });
    window.addEventListener("hashchange", () => {
      this.fromHash();
      this.followHash();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.map.redraw();
      this.timeline.redraw();
    });
    document.addEventListener("keydown", (event) => this.key(event));
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const typing = target.matches("input, select, textarea");
    if (typing && event.key === "Escape") target.blur();
    if (typing || event.ctrlKey || event.metaKey || event.altKey || this.help.open) return;
    // On a button the space bar presses the button.
    if (event.key === " " && target.matches("button")) return;
    const { view } = this.store;
    const tab = TABS[Number(event.key) - 1];
    const keys: Record<string, () => void> = {
      ArrowLeft: () => this.seek(view.index - 1),
      ArrowRight: () => this.seek(view.index + 1),
      Home: () => this.seek(0),
      End: () => this.seek(Number.MAX_SAFE_INTEGER),
      " ": () => this.play(!view.playing),
      "?": () => this.help.showModal(),
      g: () => this.focusGoals(),
      "/": () => this.focusGoals("input"),
      m: () => (view.solid ? this.solidCanvas : this.mapCanvas).focus(),
      t: () => this.swapAxis(),
      v: () => this.store.set({ solid: !view.solid }),
      s: () => this.store.set({ shaded: !view.shaded }),
      d: () => this.swapTheme(),
      o: () => this.choose(false),
      c: () => this.choose(true),
      "[": () => this.store.set({ wipe: Math.max(0, view.wipe - 0.05) }),
      "]": () => this.store.set({ wipe: Math.min(1, view.wipe + 0.05) }),
      l: () => this.nextLayer(1),
      L: () => this.nextLayer(-1),
      Escape: () => this.store.set({ goal: undefined, probe: undefined }),
    };
    if (tab === "other" && !this.other) return;
    const act = tab ? () => this.store.set({ tab }) : keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  private choose(beside: boolean): void {
    this.beside = beside;
    this.file.click();
  }

  private focusGoals(what?: string): void {
    this.store.set({ tab: "goals" });
    requestAnimationFrame(() => {
      if (what) this.panel.goals.element.querySelector<HTMLElement>(what)?.focus();
      else this.panel.goals.focus();
    });
  }

  private nextLayer(by: number): void {
    const all = [...this.layers.options].map((option) => option.value);
    const next = all[(all.indexOf(this.store.view.layer) + by + all.length) % all.length];
    if (next) this.store.set({ layer: next });
  }

  private savePng(): void {
    const name = `${this.run?.facts.run.mission ?? "map"}-${this.run?.moment(this.store.view.index)?.number ?? 0}.png`;
    const canvas = this.store.view.solid ? this.solidCanvas : this.mapCanvas;
    canvas.toBlob((blob) => blob && save(name, blob));
  }

  private saveCsv(): void {
    const { run } = this;
    const moment = run?.moment(this.store.view.index);
    if (!run || !moment) return;
    this.panel.goals.show(moment, run.moment(this.store.view.index - 1), run.facts, this.store.view.goal);
    save(`goals-${moment.number}.csv`, new Blob([this.panel.goals.csv()], { type: "text/csv" }));
  }
}

const valueAt = async (planes: Planes, id: string, decision: number, cell: Cell): Promise<number | undefined> => {
  const plane = await planes.at(id, decision);
  return plane && at(plane, cell);
};

/** What colours a layer is shown in, and from where to where. */
const scaleOf = (layer: string, plane: Plane | undefined, colours: View["colours"]): Scale => {
  if (layer === "map:interest" || layer.startsWith("doubt:")) return { colours: layer.startsWith("doubt:") ? "cividis" : colours, min: 0, max: 1 };
  const found = (plane && range(plane)) ?? { min: 0, max: 1 };
  if (layer === DIFFERENCE || layer === BETWEEN) {
    const most = Math.max(0.05, Math.abs(found.min), Math.abs(found.max));
    return { colours: "diverging", min: -most, max: most };
  }
  return { colours: layer.endsWith(":elevation") ? "stone" : colours, ...found };
};

/** As many decimals as a step of the legend needs. */
const legendLabel = (value: number, span: number): string => value.toFixed(Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(span || 1)))));

/** What the lines on the map are. */
const wayKey = (): HTMLElement =>
  h(
    "p",
    { class: "ways sub" },
    ["driven", "next leg", "plan"].map((way) => h("span", {}, h("i", { class: way.replace(" ", "-") }), way)),
  );

const readTheme = (): Theme => {
  try {
    const kept = localStorage.getItem("wisdom-theme");
    return THEMES.find((theme) => theme === kept) ?? "auto";
  } catch {
    return "auto";
  }
};
