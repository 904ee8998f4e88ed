// What the ground is drawn from: the layer at the decision shown, of one run or two, flat or in three dimensions.

import { difference, differing } from "../model/plane";
import type { Plane } from "../model/plane";
import { DERIVED } from "../planes";
import { STATES } from "../model/states";
import type { GoalState } from "../model/states";
import type { Aspect, Store } from "../state";
import { h } from "../ui/dom";
import { plain } from "../ui/format";
import { beyondNote, Legend } from "../ui/legend";
import type { LegendWords } from "../ui/legend";
import { MapView } from "../view/map";
import type { Beside, MapHandlers, MapScene, MapSide } from "../view/map";
import type { Scale } from "../view/paint";
import { shapes } from "../view/shapes";
import type { Way } from "../view/shapes";
import { SolidView } from "../view/solid";
import type { SolidScene } from "../view/solid";
import { aspectTitle, className, classesShown, scaleOf } from "./choices";
import type { Choice } from "./choices";
import { cautions, whyLacking, whyNone } from "./lacking";
import type { Layers } from "./layers";
import { apart } from "./side";
import { leadOf } from "./lead";
import type { Side, Sides } from "./side";
import { Turns } from "./turns";

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
  private late: number | undefined;
  private readonly turns = new Turns();

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
    const { view } = this.store;
    if (!a?.run?.moment(a.index)) return;
    this.wait();
    this.draw();
    const alike = (): boolean => this.sides.a === a && this.sides.b === b;
    const kind = view.layer.startsWith(DERIVED) ? "derived" : "log";
    await this.turns.take(`${kind}/${a.serial}/${b?.serial}`, async () => (await this.fetch(a, b)) || !alike());
  }

  /** What takes longer than it may without a word gets one. */
  private wait(): void {
    const say = (): void => {
      this.waiting = `${this.layers.choice?.label ?? "the map"}: being worked out …`;
    };
    if (this.waiting) say();
    this.late ??= window.setTimeout(() => {
      say();
      this.draw();
    }, LATE_MS);
  }

  /** Says whether what came is still what is looked at. */
  private async fetch(a: Side, b: Side | undefined): Promise<boolean> {
    const { choice } = this.layers;
    const { view } = this.store;
    const moment = a.run?.moment(a.index);
    if (!moment) return true;
    const state = (): string => `${view.layer}/${view.aspect}/${this.sides.a?.index}/${this.sides.b?.index}`;
    const [was, indexA, indexB] = [state(), a.index, b?.index];
    // One may have moved on meanwhile.
    const current = (): boolean => this.sides.a === a && this.sides.b === b && state() === was;
    let [planes, failed]: [[Plane | undefined, Plane | undefined], string] = [[undefined, undefined], ""];
    try {
      const lights = [a.relief ? undefined : a.light(moment.number), b?.relief ? undefined : b?.light(b.run?.moment(b.index)?.number ?? 0)];
      if (choice) planes = await this.planes(a, b);
      await Promise.all(lights);
    } catch (error) {
      failed = error instanceof Error ? error.message : String(error);
    }
    if (!current()) return false;
    [a.plane, a.planeIndex] = [planes[0], indexA];
    if (b) [b.plane, b.planeIndex] = [planes[1], indexB];
    if (choice) {
      this.scale = scaleOf(choice, view.aspect, planes, view.colours);
      this.shown = { choice, aspect: view.aspect, odd: planes.some((plane) => plane && hasOdd(plane, this.scale)) };
    }
    this.missing = planes[0] ? "" : failed ? `This map cannot be had: ${failed}` : whyNone(view, this.sides);
    this.waiting = "";
    window.clearTimeout(this.late);
    this.late = undefined;
    this.draw();
    document.documentElement.dataset.drawn = String(moment.number);
    // What is likely to be wanted next; what must be worked out first waits until it is asked for.
    const next = a.run?.moment(a.index + 1);
    if (next && /^(map|read|doubt):/.test(view.layer)) a.planes.at(view.layer, next.number).catch(() => undefined);
    return true;
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
    const wipe: Beside = apart(this.sides) ? "apart" : view.split === "halves" ? "halves" : view.wipe;
    const grown = a.run.outcomes.size + (b?.run?.outcomes.size ?? 0);
    const scene: MapScene = { ...side, scale: this.scale, grown, probe: view.probe, probed: view.probed, stale: this.waiting !== "", ...(other ? { other: { ...other, wipe } } : {}) };
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
    return probe && !this.solid && !apart(this.sides) ? this.map.viewport.place(probe).x : undefined;
  }

  /** A share of the width, near the middle of the ground, at which a line hides neither a rover nor the goal it goes to. */
  freeWipe(): number {
    return this.map.freeWipe() ?? this.store.view.wipe;
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
    const { a, b } = this.sides;
    const { view } = this.store;
    const { shown } = this;
    if (!a || !shown || (!a.plane && !b?.plane)) return undefined;
    const { choice, aspect, odd } = shown;
    const heights = solid && this.solidView ? [`heights × ${plain(this.solidView.heightStretch)}`] : [];
    const light = view.shaded && a.relief ? `relief × ${a.relief.stretch}, light from the north-west` : "no relief";
    const alternatives = view.alternatives || view.option !== undefined;
    const drawn = [this.scene, this.scene?.other].flatMap((side) => (side ? shapes(side) : []));
    const kinds = new Set<Way["what"] | GoalState>(drawn.flatMap((shape) => (shape.kind === "way" ? shape.what : shape.kind === "mark" ? shape.state : [])));
    const unknown = a.ways === "pending" ? "ways of alternatives: being worked out …" : a.ways ? undefined : "ways of alternatives are not in the log: straight lines from pose to pose";
    return {
      title: aspectTitle(choice, aspect),
      scale: this.scale,
      classes: classesShown(choice, aspect).map(className),
      odd,
      notes: [...beyondNote(this.scale), [...heights, light].join(", "), ...(alternatives && unknown ? [unknown] : [])],
      cautions: cautions(view, this.sides, solid, this.missing, this.waiting !== ""),
      ways: ["driven", "next leg", "plan", ...(alternatives ? (["alternative"] as const) : []), ...(kinds.has("pose to goal") ? (["pose to goal"] as const) : [])],
      marks: STATES.filter((state) => kinds.has(state)),
    };
  }

  /** The layer of both runs; where it is of both, the same for both. */
  private async planes(a: Side, b: Side | undefined): Promise<[Plane | undefined, Plane | undefined]> {
    const { view } = this.store;
    const classes = (this.layers.choice?.classes.length ?? 0) > 0;
    const layer = (side: Side | undefined): Promise<Plane | undefined> | undefined => side?.layer(view.layer, view.aspect === "change", classes);
    // The second run may lack what the first has.
    let failed = "";
    const [one, other] = await Promise.all([
      layer(a),
      layer(b)?.catch((error: unknown) => {
        failed = error instanceof Error ? error.message : String(error);
        return undefined;
      }),
    ]);
    if (b) b.lacks = other ? "" : failed || whyLacking(view, b);
    if (view.aspect !== "between") return [one, other];
    const both = one && other && !apart(this.sides) ? (classes ? differing(one, other) : difference(one, other)) : undefined;
    return [both, both];
  }

  private side(side: Side): MapSide | undefined {
    const { run, index, plane, relief } = side;
    const { view } = this.store;
    if (!run) return undefined;
    if (view.alternatives || view.option !== undefined) side.meetFamily(() => this.draw());
    const lead = side === leadOf(this.sides, view);
    // A layer comes a moment after its decision. Until then, or until that is said, goals stay with the layer that they are of.
    const held = this.waiting ? index : (side.planeIndex ?? index);
    return {
      run,
      index: held,
      plane,
      relief: view.shaded ? relief : undefined,
      goal: lead ? view.goal : undefined,
      option: lead ? view.option : undefined,
      alternatives: view.alternatives,
      family: side.ways === "pending" ? undefined : side.ways,
    };
  }

  private drawSolid(scene: MapScene): void {
    const { a, b } = this.sides;
    if (!a?.relief) return;
    const { other } = scene;
    // A second run of which no heights are known stands on the ground of the first, unless its own is another.
    const heights = b?.relief ?? (other?.wipe === "apart" ? undefined : a.relief);
    // Of a difference there is but one ground.
    const alone = this.store.view.aspect === "between" && other?.wipe !== "apart";
    const beside = other && heights && !alone ? { ...other, plane: scene.stale ? undefined : other.plane, elevation: heights.plane } : undefined;
    const solid: SolidScene = { ...scene, plane: scene.stale ? undefined : scene.plane, elevation: a.relief.plane, heights: this.store.view.heights, other: beside };
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
