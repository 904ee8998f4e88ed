// What the ground is drawn from: the layer at the decision shown, of one run or two, flat or in three dimensions.

import { difference } from "../model/plane";
import type { Plane } from "../model/plane";
import { BETWEEN, DIFFERENCE } from "../planes";
import type { Store } from "../state";
import { h } from "../ui/dom";
import { plain } from "../ui/format";
import { Legend } from "../ui/legend";
import { MapView } from "../view/map";
import type { MapHandlers } from "../view/map";
import type { Scale } from "../view/paint";
import { SolidView } from "../view/solid";
import { layerName, scaleOf } from "./layers";
import type { Sides } from "./side";

export class Ground {
  readonly mapCanvas = h("canvas", { class: "map", tabindex: 0, "aria-label": "Map. Keys: + − 0, Shift and arrows, Alt and arrows" });
  readonly solidCanvas = h("canvas", { class: "solid", tabindex: 0, hidden: true, "aria-label": "The ground in three dimensions" });
  readonly solidButton = h("button", { type: "button", title: "Ground in three dimensions (v)", "aria-pressed": "false", onclick: () => this.store.set({ solid: !this.store.view.solid }) }, "3-D");
  readonly legend = new Legend();
  private readonly map: MapView;
  private solidView: SolidView | undefined;
  private scale: Scale = { colours: "viridis", min: 0, max: 1 };

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
    handlers: MapHandlers,
  ) {
    this.map = new MapView(this.mapCanvas, handlers);
  }

  /** The canvas in sight. */
  get canvas(): HTMLCanvasElement {
    return this.store.view.solid ? this.solidCanvas : this.mapCanvas;
  }

  /** Puts the flat map or the solid ground in sight. */
  swap(): void {
    const { solid } = this.store.view;
    this.mapCanvas.hidden = solid;
    this.solidCanvas.hidden = !solid;
    this.solidButton.setAttribute("aria-pressed", String(solid));
  }

  /** Gets the plane of the layer, and draws it. */
  async show(): Promise<void> {
    const { a, b } = this.sides;
    const { view } = this.store;
    const { index, layer } = view;
    const moment = a?.run?.moment(index);
    if (!a || !moment) return;
    this.draw();
    const against = b?.run?.moment(b.index);
    const asked = layer === BETWEEN ? "map:interest" : layer;
    const [base, beside] = await Promise.all([
      a.planes.at(asked, moment.number),
      against && b?.planes.at(asked, against.number),
      a.relief ? undefined : a.light(moment.number),
      against && b && !b.relief ? b.light(against.number) : undefined,
    ]);
    // One may have moved on meanwhile.
    if (this.sides.a !== a || view.index !== index || view.layer !== layer) return;
    const between = layer === BETWEEN && base && beside;
    const plane = between ? difference(base, beside) : base;
    // Nothing to wipe where the map is of both.
    if (b) b.plane = between ? plane : beside;
    a.plane = plane;
    this.scale = scaleOf(layer, plane, view.colours);
    this.draw();
    this.explain(plane);
    document.documentElement.dataset.drawn = String(moment.number);
    // What is likely to be wanted next.
    const next = a.run?.moment(index + 1);
    if (next) void a.planes.at(layer, next.number);
  }

  draw(): void {
    const { a, b } = this.sides;
    const { view } = this.store;
    if (!a?.run) return;
    const beside = b?.run && { run: b.run, index: b.index, plane: b.plane, relief: view.shaded ? b.relief : undefined, wipe: view.wipe };
    const scene = {
      run: a.run,
      index: view.index,
      plane: a.plane,
      scale: this.scale,
      relief: view.shaded ? a.relief : undefined,
      goal: view.goal,
      option: view.option,
      probe: view.probe,
      ...(beside ? { other: beside } : {}),
    };
    if (view.solid && a.relief) this.solid()?.show({ ...scene, elevation: a.relief.plane });
    else this.map.show(scene);
  }

  redraw(): void {
    this.map.redraw();
  }

  zoom(factor: number): void {
    if (this.store.view.solid) this.solidView?.zoom(factor);
    else this.map.zoom(factor);
  }

  fit(): void {
    if (this.store.view.solid) this.solidView?.fit();
    else this.map.fit();
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

  private explain(plane: Plane | undefined): void {
    const { view } = this.store;
    if (!plane) {
      this.legend.none(view.layer === DIFFERENCE ? "There is no decision before this one." : "The log holds no such map at this decision.");
      return;
    }
    const relief = this.sides.a?.relief;
    const heights = view.solid && this.solidView ? `heights × ${plain(this.solidView.heightStretch)}, ` : "";
    const light = view.shaded && relief ? `relief × ${relief.stretch}, light from the north-west` : "no relief";
    this.legend.show(layerName(view.layer, this.sides.a?.run?.planes ?? []), this.scale, heights + light);
  }
}
