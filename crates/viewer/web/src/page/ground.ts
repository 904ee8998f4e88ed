// What the ground is drawn from: the layer at the decision shown, of one run or two, flat or in three dimensions.

import { difference, differing } from "../model/plane";
import type { Plane } from "../model/plane";
import type { Aspect, Store } from "../state";
import { h } from "../ui/dom";
import { plain } from "../ui/format";
import { Legend } from "../ui/legend";
import type { LegendWords } from "../ui/legend";
import { MapView } from "../view/map";
import type { MapHandlers, MapScene, MapSide } from "../view/map";
import type { Scale } from "../view/paint";
import { SolidView } from "../view/solid";
import type { SolidScene } from "../view/solid";
import { aspectTitle, className, classesShown, scaleOf } from "./choices";
import type { Choice } from "./choices";
import type { Layers } from "./layers";
import type { Side, Sides } from "./side";

/** Work that takes no longer goes without saying. */
const LATE_MS = 300;

export class Ground {
  readonly mapCanvas = h("canvas", { class: "map", tabindex: 0, "aria-label": "Map. Keys: + − 0, Shift and arrows, Alt and arrows" });
  readonly solidCanvas = h("canvas", { class: "solid", tabindex: 0, hidden: true, "aria-label": "The ground in three dimensions. Keys: + − 0, Shift and arrows" });
  readonly legend = new Legend();
  private readonly map: MapView;
  private scene: MapScene | undefined;
  private solidView: SolidView | undefined;
  private scale: Scale = { colours: "viridis", min: 0, max: 1 };
  /** What is on the map now: it may be a while until it is what was chosen. */
  private shown: { choice: Choice; aspect: Aspect; odd: boolean } | undefined;
  /** Why there is no map, if there is none. */
  private missing = "";
  private told = "";
  /** What is said while a map is being worked out. */
  private waiting = "";

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
    private readonly layers: Layers,
    handlers: MapHandlers,
    /** Told if this browser draws nothing in three dimensions. */
    private readonly noSolid: () => void,
  ) {
    this.map = new MapView(this.mapCanvas, handlers);
  }

  /** Whether the ground stands up: it needs heights. */
  get solid(): boolean {
    return this.store.view.solid && this.sides.a?.relief !== undefined;
  }

  /** The canvas in sight. */
  get canvas(): HTMLCanvasElement {
    return this.solid ? this.solidCanvas : this.mapCanvas;
  }

  /** Gets the planes of the layer, and draws them. */
  async show(): Promise<void> {
    const { a, b } = this.sides;
    const { choice } = this.layers;
    const { view } = this.store;
    const moment = a?.run?.moment(view.index);
    if (!a || !moment) return;
    this.draw();
    const state = (): string => `${view.layer}/${view.aspect}/${view.index}/${this.sides.b?.index}`;
    const was = state();
    // One may have moved on meanwhile.
    const current = (): boolean => this.sides.a === a && this.sides.b === b && state() === was;
    this.waiting = "";
    const late = setTimeout(() => {
      if (!current()) return;
      this.waiting = `${choice?.label ?? "the map"}: being worked out …`;
      this.explain();
    }, LATE_MS);
    let [planes, failed]: [[Plane | undefined, Plane | undefined], string] = [[undefined, undefined], ""];
    try {
      const lights = [a.relief ? undefined : a.light(moment.number), b?.relief ? undefined : b?.light(b.run?.moment(b.index)?.number ?? 0)];
      if (choice) planes = await this.planes(a, b);
      await Promise.all(lights);
    } catch (error) {
      failed = error instanceof Error ? error.message : String(error);
    } finally {
      clearTimeout(late);
    }
    if (!current()) return;
    a.plane = planes[0];
    if (b) b.plane = planes[1];
    if (choice) {
      this.scale = scaleOf(choice, view.aspect, planes, view.colours);
      this.shown = { choice, aspect: view.aspect, odd: planes.some((plane) => plane && hasOdd(plane, this.scale)) };
    }
    this.missing = planes[0] ? "" : failed ? `This map cannot be had: ${failed}` : this.why();
    this.waiting = "";
    this.draw();
    document.documentElement.dataset.drawn = String(moment.number);
    // What is likely to be wanted next; what must be worked out first waits until it is asked for.
    const next = a.run?.moment(view.index + 1);
    if (next && /^(map|read|doubt):/.test(view.layer)) a.planes.at(view.layer, next.number).catch(() => undefined);
  }

  draw(): void {
    const { a, b } = this.sides;
    const { view } = this.store;
    if (!a?.run) return;
    this.mapCanvas.hidden = this.solid;
    this.solidCanvas.hidden = !this.solid;
    const side = this.side(a);
    const other = b && this.side(b);
    if (!side) return;
    const wipe = view.split === "halves" ? ("halves" as const) : view.wipe;
    const scene: MapScene = { ...side, scale: this.scale, grown: a.run.outcomes.size + (b?.run?.outcomes.size ?? 0), probe: view.probe, ...(other ? { other: { ...other, wipe } } : {}) };
    this.scene = scene;
    if (this.solid) this.drawSolid(scene);
    else this.map.show(scene);
    this.explain();
  }

  redraw(): void {
    this.map.redraw();
  }

  /** Where the cell asked about lies across the map, if it is in sight. */
  get probeX(): number | undefined {
    const { probe } = this.store.view;
    return probe && !this.solid ? this.map.viewport.place(probe).x : undefined;
  }

  /** The flat map as it is now, in sight or not. */
  get flat(): MapView {
    if (this.scene) this.map.show(this.scene);
    return this.map;
  }

  zoom(factor: number): void {
    if (this.solid) this.solidView?.zoom(factor);
    else this.map.zoom(factor);
  }

  fit(): void {
    if (this.solid) this.solidView?.fit();
    else this.map.fit();
  }

  /** What the legend says of the map, flat or standing up; nothing if there is none. */
  words(solid: boolean): LegendWords | undefined {
    const { a } = this.sides;
    const { view } = this.store;
    const { shown } = this;
    if (!a?.plane || !shown) return undefined;
    const { choice, aspect, odd } = shown;
    const heights = solid && this.solidView ? [`heights × ${plain(this.solidView.heightStretch)}`] : [];
    const light = view.shaded && a.relief ? `relief × ${a.relief.stretch}, light from the north-west` : "no relief";
    const alternatives = view.alternatives || view.option !== undefined;
    const unknown = a.ways === "pending" ? "ways of alternatives: being worked out …" : a.ways ? undefined : "ways of alternatives are not in the log: straight lines from pose to pose";
    return {
      title: aspectTitle(choice, aspect),
      scale: this.scale,
      classes: classesShown(choice, aspect).map(className),
      odd,
      notes: [[...heights, light].join(", "), ...(alternatives && unknown ? [unknown] : [])],
      ways: ["driven", "next leg", "plan", ...(alternatives ? (["alternative"] as const) : [])],
    };
  }

  /** The layer of both runs; where it is of both, the same for both. */
  private async planes(a: Side, b: Side | undefined): Promise<[Plane | undefined, Plane | undefined]> {
    const { view } = this.store;
    const classes = (this.layers.choice?.classes.length ?? 0) > 0;
    const layer = (side: Side | undefined): Promise<Plane | undefined> | undefined => side?.layer(view.layer, view.aspect === "change", classes);
    // The second run may lack what the first has.
    const [one, other] = await Promise.all([layer(a), layer(b)?.catch(() => undefined)]);
    if (view.aspect !== "between") return [one, other];
    const both = one && other && sameGrid(a, b) ? (classes ? differing(one, other) : difference(one, other)) : undefined;
    return [both, both];
  }

  private why(): string {
    const { a, b } = this.sides;
    const { view } = this.store;
    if (view.aspect === "change" && view.index === 0) return "There is no decision before this one.";
    if (view.aspect === "between" && a && !sameGrid(a, b)) return "The grids of the two runs differ: their maps cannot be compared.";
    if (view.aspect === "between" && a) return "Not both runs hold this map at these decisions.";
    return "There is no such map at this decision.";
  }

  private side(side: Side): MapSide | undefined {
    const { run, index, plane, relief } = side;
    const { view } = this.store;
    if (!run) return undefined;
    if (view.alternatives || view.option !== undefined) side.meetFamily(() => this.draw());
    const first = side === this.sides.a;
    return {
      run,
      index,
      plane,
      relief: view.shaded ? relief : undefined,
      goal: first ? view.goal : undefined,
      option: first ? view.option : undefined,
      alternatives: view.alternatives,
      family: side.ways === "pending" ? undefined : side.ways,
    };
  }

  private drawSolid(scene: MapScene): void {
    const { a, b } = this.sides;
    if (!a?.relief) return;
    const { other } = scene;
    // A second run of which no heights are known stands on the ground of the first.
    const beside = other && { ...other, elevation: (b?.relief ?? a.relief).plane };
    const solid: SolidScene = { ...scene, elevation: a.relief.plane, heights: this.store.view.heights, other: beside };
    this.solidMade()?.show(solid);
  }

  /** The view in three dimensions, made when it is first wanted: it takes a while and a graphics context. */
  private solidMade(): SolidView | undefined {
    try {
      this.solidView ??= new SolidView(this.solidCanvas);
    } catch {
      this.store.set({ solid: false });
      this.noSolid();
    }
    return this.solidView;
  }

  private explain(): void {
    const words = this.waiting ? undefined : this.words(this.solid);
    const why = this.waiting || this.missing;
    const telling = words ? JSON.stringify(words) : why;
    if (telling === this.told || telling === "") return;
    this.told = telling;
    if (words) this.legend.show(words);
    else this.legend.none(why);
  }
}

/** Whether a plane of classes holds what is none of them. */
const hasOdd = ({ values }: Plane, { classes }: Scale): boolean => classes !== undefined && values.some((value) => !Number.isNaN(value) && !classes.includes(value));

const sameGrid = (a: Side, b: Side | undefined): boolean => {
  const [one, other] = [a.run?.facts.grid, b?.run?.facts.grid];
  return one !== undefined && other !== undefined && JSON.stringify(one) === JSON.stringify(other);
};
