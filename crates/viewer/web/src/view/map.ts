// The map: a layer over relief, with goals, rover, ways and what the pointer asks about; of one run or of two.

import type { Plane } from "../model/plane";
import type { Cell } from "../model/types";
import { FlatSurface, token } from "./canvas";
import type { Size } from "./canvas";
import { listenMap } from "./map-input";
import { paint } from "./paint";
import type { Scale } from "./paint";
import { drawLabel, drawShapes } from "./pen";
import type { Relief } from "./relief";
import { shapes } from "./shapes";
import type { Mark, Marked, Shape } from "./shapes";
import { Viewport } from "./viewport";
import type { Keep } from "./viewport";

/** One run on its ground. */
export interface MapSide extends Marked {
  plane: Plane | undefined;
  relief: Relief | undefined;
}

/** How the second run stands to the first: right of a wipe at this share of the width, in a half of its own, or there on other ground. */
export type Beside = number | "halves" | "apart";

/** What is drawn. */
export interface MapScene extends MapSide {
  scale: Scale;
  /** How far the runs were read: while they are, more comes without any of the rest changing. */
  grown: number;
  probe: Cell | undefined;
  /** Of which run that cell is, where the other has none such. */
  probed: "a" | "b";
  /** Whether the layer is not that of the decision, because that one is still being worked out. */
  stale: boolean;
  other?: MapSide & { wipe: Beside };
}

export interface MapHandlers {
  wipe(share: number): void;
  /** Asks about a cell of the first run or of the second. */
  probe(cell: Cell | undefined, of: "a" | "b"): void;
  pick(goal: number | undefined, of: "a" | "b"): void;
}

/** The part of the canvas that shows one run: from where to where, and how far its grid is moved. */
export interface Panel {
  side: MapSide;
  of: "a" | "b";
  x: number;
  width: number;
  dx: number;
  /** Where the cells of its grid lie before it is moved. */
  viewport: Viewport;
  shapes: Shape[];
  /** A pixel a cell. */
  picture: HTMLCanvasElement | undefined;
}

/** A plane as it was painted last. */
interface Picture {
  canvas: HTMLCanvasElement;
  plane?: Plane;
  relief?: Relief;
  scale?: string;
}

/** What a wipe keeps clear of at first, and how many places it tries: half of the ground either way. */
const WIPE_CLEAR_PX = 26;
const WIPE_TRIES = 45;
/** How near to a mark a click must come. */
const REACH_PX = 14;
/** Room that legend and values take on the left, and buttons on the right; of two halves, above and below. */
const KEPT: Keep = { left: 280, right: 30, top: 0, bottom: 0 };
/** The column is narrower where there is less room; the style sheet has the same limit. */
const NARROW_PX = 700;
const KEPT_IF_NARROW: Keep = { ...KEPT, left: 214 };
/** How much of a layer of another decision is left in sight. */
const STALE_ALPHA = 0.3;
const KEPT_OF_HALF: Keep = { left: 0, right: 0, top: 60, bottom: 72 };

export class MapView {
  readonly viewport = new Viewport();
  /** That of the second run, where it is on other ground. */
  private readonly second = new Viewport();
  private readonly surface: FlatSurface;
  /** As it was laid out last: while the page is printed the canvas may measure otherwise than what is drawn on it. */
  private size: Size;
  private readonly pictures: Record<"a" | "b", Picture> = { a: { canvas: document.createElement("canvas") }, b: { canvas: document.createElement("canvas") } };
  private scene: MapScene | undefined;
  private marks: Record<"a" | "b", Mark[]> = { a: [], b: [] };
  /** What was drawn last, but for the cell asked about, which moves with the pointer. */
  private readonly drawn = document.createElement("canvas");
  private stale = true;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly handlers: MapHandlers,
  ) {
    this.surface = new FlatSurface(
      canvas,
      (size) => this.draw(size),
      () => this.resized(),
    );
    this.size = this.surface.size;
    listenMap(this, handlers);
  }

  show(scene: MapScene): void {
    const was = this.scene;
    this.scene = scene;
    const moved = !was || !alike(was, scene);
    if (was?.run !== scene.run || inHalves(was) !== inHalves(scene) || (this.apart && was.other?.run !== scene.other?.run)) this.fit();
    if (moved) this.redraw();
    else this.surface.redraw();
  }

  /** The whole grid in sight. */
  fit(): void {
    const grid = this.scene?.run.facts.grid;
    if (!grid || grid.rows === 0) return;
    const { width, height } = this.size;
    if (this.halves) this.viewport.fit(grid, width / 2, height, KEPT_OF_HALF);
    else this.viewport.fit(grid, width, height, width < NARROW_PX ? KEPT_IF_NARROW : KEPT);
    const other = this.scene?.other?.run.facts.grid;
    if (other && other.rows > 0) this.second.fit(other, width / 2, height, KEPT_OF_HALF);
    this.redraw();
  }

  /** Nearer by a factor, about a pixel, or about the middle. */
  zoom(factor: number, px?: number, py?: number): void {
    const { width, height } = this.size;
    const middle = this.halves ? width / 4 : width / 2;
    for (const viewport of [this.viewport, this.second]) viewport.zoom(factor, px === undefined ? middle : px - this.movedAt(px), py ?? height / 2);
    this.redraw();
  }

  pan(dx: number, dy: number): void {
    for (const viewport of [this.viewport, this.second]) viewport.pan(dx, dy);
    this.redraw();
  }

  redraw(): void {
    this.stale = true;
    this.surface.redraw();
  }

  get height(): number {
    return this.size.height;
  }

  /** Where the wipe stands, if there is one. */
  get wipeX(): number | undefined {
    const wipe = this.scene?.other?.wipe;
    return typeof wipe === "number" ? wipe * this.size.width : undefined;
  }

  /** Where a wipe would hide neither rover nor next goal of either run, as near to the middle of the ground as may be; a share of the width. */
  freeWipe(): number | undefined {
    const { scene } = this;
    if (!scene?.other || this.size.width === 0) return undefined;
    const { x, scale } = this.viewport;
    const { cols } = scene.run.facts.grid;
    const taken = [scene, scene.other].flatMap((side) => shapes(side).flatMap((shape) => (shape.kind === "rover" || (shape.kind === "mark" && shape.state === "next") ? this.viewport.place(shape.cell).x : [])));
    const middle = x + (cols * scale) / 2;
    const tries = Array.from({ length: WIPE_TRIES }, (_, i) => middle + (i % 2 === 0 ? 1 : -1) * Math.ceil(i / 2) * (cols * scale) * 0.02);
    const free = tries.find((at) => taken.every((one) => Math.abs(one - at) > WIPE_CLEAR_PX));
    return free === undefined ? undefined : free / this.size.width;
  }

  /** The cell under a pixel, and of which run. */
  asked(px: number, py: number): { cell: Cell | undefined; of: "a" | "b" } {
    const of = this.sideAt(px);
    const second = this.apart && of === "b";
    const grid = (second ? this.scene?.other : this.scene)?.run.facts.grid;
    return { cell: grid && (second ? this.second : this.viewport).cellAt(px - this.movedAt(px), py, grid), of };
  }

  /** The cell asked about, moved by keys; at first the rover's. */
  step(dx: number, dy: number): void {
    const { scene } = this;
    const from = (this.apart && scene?.probed === "b" ? undefined : scene?.probe) ?? scene?.run.moment(scene.index)?.pose;
    if (!scene || !from) return;
    const { rows, cols } = scene.run.facts.grid;
    const within = (value: number, size: number): number => Math.min(size - 1, Math.max(0, value));
    const cell = { row: within(from.row + dy, rows), col: within(from.col + dx, cols) };
    const { x } = this.viewport.place(cell);
    // Which run is in sight there: of two halves the first shows every cell.
    this.handlers.probe(cell, this.halves ? "a" : this.sideAt(x));
  }

  /** The goal under a pixel, of the run in sight there. */
  goalAt(px: number, py: number): number | undefined {
    const of = this.sideAt(px);
    const dx = this.movedAt(px);
    const near = this.marks[of]
      .map((mark) => {
        const { x, y } = this.viewport.place(mark.cell);
        return { goal: mark.goal, away: Math.hypot(px - dx - x, py - y) };
      })
      .filter(({ away }) => away <= REACH_PX);
    // The mark on top is the last drawn; of equals it wins.
    return near.reverse().sort((a, b) => a.away - b.away)[0]?.goal;
  }

  /** What is shown of each run, and where. */
  panels(): Panel[] {
    const { scene } = this;
    if (!scene) return [];
    const { width } = this.size;
    const panel = (side: MapSide, of: "a" | "b", x: number, to: number, dx: number): Panel => ({ side, of, x, width: to - x, dx, viewport: of === "b" && this.apart ? this.second : this.viewport, shapes: shapes(side), picture: this.picture(side, of, scene.scale) });
    if (!scene.other) return [panel(scene, "a", 0, width, 0)];
    const at = this.wipeX ?? width / 2;
    return [panel(scene, "a", 0, at, 0), panel(scene.other, "b", at, width, this.halves ? width / 2 : 0)];
  }

  private resized(): void {
    // On paper stands what was on the screen.
    if (matchMedia("print").matches) return;
    this.size = this.surface.size;
    this.stale = true;
    if (this.viewport.fitted) this.fit();
  }

  private get halves(): boolean {
    return inHalves(this.scene);
  }

  private get apart(): boolean {
    return this.scene?.other?.wipe === "apart";
  }

  /** The run in sight at a pixel. */
  sideAt(px: number): "a" | "b" {
    return this.scene?.other && px > (this.wipeX ?? this.size.width / 2) ? "b" : "a";
  }

  private movedAt(px: number): number {
    return this.halves && this.sideAt(px) === "b" ? this.size.width / 2 : 0;
  }

  private draw(size: Size): void {
    const { scene, drawn } = this;
    const { context, canvas } = this.surface;
    if (!scene) return;
    const whole = (to: CanvasRenderingContext2D | null, from: HTMLCanvasElement): void => {
      to?.save();
      to?.resetTransform();
      to?.drawImage(from, 0, 0);
      to?.restore();
    };
    if (this.stale) {
      this.stale = false;
      this.all(scene, size);
      [drawn.width, drawn.height] = [canvas.width, canvas.height];
      whole(drawn.getContext("2d"), canvas);
    } else {
      whole(context, drawn);
    }
    const { probe } = scene;
    if (!probe) return;
    for (const panel of this.panels()) if (!this.apart || panel.of === scene.probed) this.within(panel, size.height, () => this.crosshair(probe, panel.viewport));
  }

  private all(scene: MapScene, { width, height }: Size): void {
    for (const panel of this.panels()) {
      this.within(panel, height, () => {
        this.ground(panel);
        drawShapes(this.surface.context, panel.shapes, (cell) => panel.viewport.place(cell), panel.x - panel.dx, panel.x - panel.dx + panel.width, height);
      });
      this.marks[panel.of] = panel.shapes.filter((shape) => shape.kind === "mark");
    }
    if (scene.other) this.divide(this.wipeX ?? width / 2, height);
  }

  /** Draws in a panel's own place, and nowhere else. */
  private within({ x, width, dx }: Panel, height: number, draw: () => void): void {
    const { context } = this.surface;
    context.save();
    context.beginPath();
    context.rect(x, 0, width, height);
    context.clip();
    context.translate(dx, 0);
    draw();
    context.restore();
  }

  /** The line between two runs; of a wipe with a handle. */
  private divide(at: number, height: number): void {
    const { context } = this.surface;
    const x = Math.round(at);
    context.lineWidth = 4;
    context.strokeStyle = "#fff";
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, height);
    context.stroke();
    context.lineWidth = 1.5;
    context.strokeStyle = "#111";
    context.stroke();
    drawLabel(context, "A", x - 14, this.halves ? 58 : 14);
    drawLabel(context, this.apart ? "B, other ground" : "B", x + (this.apart ? 58 : 14), this.halves ? 58 : 14);
    if (this.halves) return;
    context.beginPath();
    context.roundRect(x - 5, height / 2 - 18, 10, 36, 5);
    context.fillStyle = "#111";
    context.strokeStyle = "#fff";
    context.lineWidth = 2;
    context.fill();
    context.stroke();
  }

  private ground({ side, picture, viewport }: Panel): void {
    const { context } = this.surface;
    const { scale, x, y } = viewport;
    const { grid } = side.run.facts;
    context.fillStyle = token("--map-unknown");
    context.fillRect(x, y, grid.cols * scale, grid.rows * scale);
    const { plane } = side;
    if (plane && picture) {
      // Cells are what was fused: they keep their edges when there is room to see them. Classes have nothing between.
      context.imageSmoothingEnabled = scale < 1 && !this.scene?.scale.classes;
      context.globalAlpha = this.scene?.stale ? STALE_ALPHA : 1;
      context.drawImage(picture, x + plane.col * scale, y + plane.row * scale, plane.cols * scale, plane.rows * scale);
      context.globalAlpha = 1;
    }
    context.strokeStyle = token("--map-edge");
    context.lineWidth = 1;
    context.strokeRect(x - 0.5, y - 0.5, grid.cols * scale + 1, grid.rows * scale + 1);
  }

  private picture({ plane, relief }: MapSide, of: "a" | "b", shown: Scale): HTMLCanvasElement | undefined {
    if (!plane || plane.values.length === 0) return undefined;
    const picture = this.pictures[of];
    const scale = JSON.stringify(shown);
    if (picture.plane !== plane || picture.relief !== relief || picture.scale !== scale) {
      picture.canvas.width = plane.cols;
      picture.canvas.height = plane.rows;
      picture.canvas.getContext("2d")?.putImageData(paint(plane, shown, relief), 0, 0);
      Object.assign(picture, { plane, relief, scale });
    }
    return picture.canvas;
  }

  private crosshair(cell: Cell, viewport: Viewport): void {
    const { context } = this.surface;
    const size = Math.max(viewport.scale, 5);
    const { x, y } = viewport.place(cell);
    context.lineWidth = 3;
    context.strokeStyle = "rgb(255 255 255 / 0.9)";
    context.strokeRect(x - size / 2, y - size / 2, size, size);
    context.lineWidth = 1.2;
    context.strokeStyle = "#111";
    context.strokeRect(x - size / 2, y - size / 2, size, size);
  }
}

const inHalves = (scene: MapScene | undefined): boolean => scene?.other !== undefined && typeof scene.other.wipe !== "number";

const SIDE = ["run", "index", "plane", "relief", "goal", "option", "alternatives", "family"] as const;

/** Whether two scenes differ in nothing but the cell asked about. */
const alike = (one: MapScene, other: MapScene): boolean => {
  const sides = (a: MapSide | undefined, b: MapSide | undefined): boolean => a === b || (a !== undefined && b !== undefined && SIDE.every((key) => a[key] === b[key]));
  return sides(one, other) && sides(one.other, other.other) && one.other?.wipe === other.other?.wipe && one.scale === other.scale && one.grown === other.grown && one.stale === other.stale;
};
