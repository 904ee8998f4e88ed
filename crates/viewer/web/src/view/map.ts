// The map: a layer over relief, with goals, rover, ways and what the pointer asks about.

import { sequence } from "../model/changes";
import type { Run } from "../model/run";
import { stateOf } from "../model/states";
import type { GoalState } from "../model/states";
import type { Plane } from "../model/plane";
import type { Cell, Moment } from "../model/types";
import { FlatSurface, token } from "./canvas";
import { OKABE } from "./colour";
import { filled, markPath2d, stateColour } from "./marks";
import { paint } from "./paint";
import type { Scale } from "./paint";
import type { Relief } from "./relief";

/** What is drawn. */
export interface MapScene {
  run: Run;
  index: number;
  plane: Plane | undefined;
  scale: Scale;
  relief: Relief | undefined;
  /** The goal picked out. */
  goal: number | undefined;
  /** The member of the family picked out. */
  option: number | undefined;
  probe: Cell | undefined;
  /** Another run, drawn to the right of the wipe. */
  other?: { run: Run; index: number; plane: Plane | undefined; relief: Relief | undefined; wipe: number };
}

export interface MapHandlers {
  wipe(share: number): void;
  probe(cell: Cell | undefined): void;
  pick(goal: number | undefined): void;
}

/** A plane as it was painted last. */
interface Picture {
  canvas: HTMLCanvasElement;
  plane?: Plane;
  relief?: Relief;
  scale?: string;
}

const newPicture = (): Picture => ({ canvas: document.createElement("canvas") });

interface Mark {
  goal: number;
  cell: Cell;
  state: GoalState;
  turn: number | undefined;
}

const MARK_PX = 8.5;
/** How near to a mark a click must come. */
const REACH_PX = 14;
/** Room that legend and values take on the left. */
const LEGEND_PX = 252;
const ZOOM_STEP = 1.25;
const WIPE_REACH_PX = 8;
const LEAST_SCALE = 0.4;
const MOST_SCALE = 80;

export class MapView {
  private readonly surface: FlatSurface;
  private readonly context: CanvasRenderingContext2D;
  /** The planes of both runs as pictures. */
  private readonly pictures: Picture[] = [newPicture(), newPicture()];
  private scene: MapScene | undefined;
  /** Pixels a cell, and where the grid's corner lies. */
  private scale = 1;
  private x = 0;
  private y = 0;
  private fitted = true;
  private marks: Mark[] = [];

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly handlers: MapHandlers,
  ) {
    this.surface = new FlatSurface(
      canvas,
      () => this.draw(),
      () => this.fitted && this.fit(),
    );
    this.context = this.surface.context;
    this.listen();
  }

  show(scene: MapScene): void {
    const first = this.scene === undefined || this.scene.run !== scene.run;
    this.scene = scene;
    if (first) this.fit();
    this.redraw();
  }

  /** The whole grid in sight. */
  fit(): void {
    const grid = this.scene?.run.facts.grid;
    if (!grid || grid.rows === 0) return;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const margin = 14;
    const fits = (left: number): number => Math.min((width - left - 2 * margin) / grid.cols, (height - 2 * margin) / grid.rows);
    // Beside the legend, if that makes it no smaller.
    const left = fits(LEGEND_PX) >= fits(0) * 0.97 ? LEGEND_PX : 0;
    this.scale = Math.max(LEAST_SCALE, fits(left));
    this.x = left + (width - left - grid.cols * this.scale) / 2;
    this.y = (height - grid.rows * this.scale) / 2;
    this.fitted = true;
    this.redraw();
  }

  zoom(factor: number, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2): void {
    const scale = Math.min(MOST_SCALE, Math.max(LEAST_SCALE, this.scale * factor));
    this.x = px - ((px - this.x) * scale) / this.scale;
    this.y = py - ((py - this.y) * scale) / this.scale;
    this.scale = scale;
    this.fitted = false;
    this.redraw();
  }

  pan(dx: number, dy: number): void {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
    this.redraw();
  }

  /** Where a cell's middle lies, in pixels of the canvas. */
  place(cell: Cell): { x: number; y: number } {
    return { x: this.x + (cell.col + 0.5) * this.scale, y: this.y + (cell.row + 0.5) * this.scale };
  }

  /** Metres that a hundred pixels show. */
  get metresPerPixel(): number {
    return (this.scene?.run.facts.grid.spacingM ?? 1) / this.scale;
  }

  redraw(): void {
    this.surface.redraw();
  }

  private draw(): void {
    const { scene } = this;
    if (!scene) return;
    // The second run first: marks that can be picked are those of the last drawn, which is the first run.
    if (scene.other) this.half({ ...scene, ...scene.other, goal: undefined, option: undefined }, 1);
    this.half(scene, 0);
    if (scene.other) this.wipeLine(scene.other.wipe);
    if (scene.probe) this.crosshair(scene.probe);
  }

  /** One run; of two, its side of the wipe. */
  private half(scene: MapScene, side: 0 | 1): void {
    const { context } = this;
    const moment = scene.run.moment(scene.index);
    context.save();
    if (scene.other) {
      const x = scene.other.wipe * this.canvas.clientWidth;
      context.beginPath();
      context.rect(side === 0 ? 0 : x, 0, side === 0 ? x : this.canvas.clientWidth - x, this.canvas.clientHeight);
      context.clip();
    }
    this.ground(scene, side);
    if (moment) {
      this.ways(scene, moment);
      this.goals(scene, moment);
      this.rover(moment);
    }
    context.restore();
  }

  private wipeLine(share: number): void {
    const { context } = this;
    const x = Math.round(share * this.canvas.clientWidth);
    const height = this.canvas.clientHeight;
    context.lineWidth = 4;
    context.strokeStyle = "#fff";
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, height);
    context.stroke();
    context.lineWidth = 1.5;
    context.strokeStyle = "#111";
    context.stroke();
    this.label("A", x - 14, 14);
    this.label("B", x + 14, 14);
    context.beginPath();
    context.roundRect(x - 5, height / 2 - 18, 10, 36, 5);
    context.fillStyle = "#111";
    context.strokeStyle = "#fff";
    context.lineWidth = 2;
    context.fill();
    context.stroke();
  }

  private ground(scene: MapScene, side: 0 | 1): void {
    const { context } = this;
    const { grid } = scene.run.facts;
    context.fillStyle = token("--map-unknown");
    context.fillRect(this.x, this.y, grid.cols * this.scale, grid.rows * this.scale);
    const { plane } = scene;
    if (plane && plane.values.length > 0) {
      const scale = JSON.stringify(scene.scale);
      const picture = this.pictures[side] ?? newPicture();
      if (picture.plane !== plane || picture.relief !== scene.relief || picture.scale !== scale) {
        picture.canvas.width = plane.cols;
        picture.canvas.height = plane.rows;
        picture.canvas.getContext("2d")?.putImageData(paint(plane, scene.scale, scene.relief), 0, 0);
        Object.assign(picture, { plane, relief: scene.relief, scale });
      }
      // Cells are what was fused: they keep their edges when there is room to see them.
      context.imageSmoothingEnabled = this.scale < 1;
      context.drawImage(
        picture.canvas,
        this.x + plane.col * this.scale,
        this.y + plane.row * this.scale,
        plane.cols * this.scale,
        plane.rows * this.scale,
      );
    }
    context.strokeStyle = token("--map-edge");
    context.lineWidth = 1;
    context.strokeRect(this.x - 0.5, this.y - 0.5, grid.cols * this.scale + 1, grid.rows * this.scale + 1);
  }

  private ways(scene: MapScene, moment: Moment): void {
    for (const track of scene.run.tracks(scene.index)) this.line(track, OKABE.blue, 2.2, []);
    const legs = moment.act.name === "pursue" ? moment.legs.map((leg) => leg.cells) : [moment.act.route];
    legs.slice(1).forEach((cells) => this.line(cells, OKABE.orange, 1.8, []));
    const first = legs[0];
    if (first) this.line(first, OKABE.vermilion, 2.8, []);
    const option = scene.option === undefined ? undefined : moment.family[scene.option];
    if (option && scene.option !== moment.chosen) {
      this.line([moment.pose, ...option.poses], OKABE.pink, 2, [7, 5]);
      for (const pose of option.poses) this.dot(pose, 3.2, OKABE.pink);
    }
  }

  private line(cells: readonly Cell[], colour: string, width: number, dash: number[]): void {
    if (cells.length < 2) return;
    const { context } = this;
    const path = new Path2D();
    cells.forEach((cell, i) => {
      const { x, y } = this.place(cell);
      if (i === 0) path.moveTo(x, y);
      else path.lineTo(x, y);
    });
    context.lineJoin = "round";
    context.lineCap = dash.length > 0 ? "butt" : "round";
    context.setLineDash([]);
    context.strokeStyle = "rgb(255 255 255 / 0.85)";
    context.lineWidth = width + 2.2;
    context.stroke(path);
    context.setLineDash(dash);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke(path);
    context.setLineDash([]);
  }

  private dot(cell: Cell, radius: number, colour: string): void {
    const { context } = this;
    const { x, y } = this.place(cell);
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = colour;
    context.strokeStyle = "#fff";
    context.lineWidth = 1.2;
    context.fill();
    context.stroke();
  }

  private goals(scene: MapScene, moment: Moment): void {
    const turns = sequence(moment);
    const known = [...scene.run.verdictsUpTo(scene.index).values()].map(({ verdict, index }): Mark => {
      // A goal of which nothing more is said has ended; what was last said of it stands.
      const state = stateOf(verdict, scene.run.moment(index) ?? moment);
      const turn = index === scene.index ? turns.indexOf(verdict.goal.id) : -1;
      return { goal: verdict.goal.id, cell: verdict.goal.target, state, turn: turn < 0 ? undefined : turn };
    });
    const weight: Record<GoalState, number> = { dropped: 0, deferred: 1, done: 2, planned: 3, next: 4 };
    this.marks = known.sort((a, b) => weight[a.state] - weight[b.state] || (b.turn ?? 0) - (a.turn ?? 0));
    for (const mark of this.marks) this.mark(mark, mark.goal === scene.goal);
  }

  private mark({ goal, cell, state, turn }: Mark, picked: boolean): void {
    const { context } = this;
    const { x, y } = this.place(cell);
    const small = state === "dropped" || state === "deferred";
    const path = markPath2d(state, small ? MARK_PX * 0.68 : MARK_PX);
    context.save();
    context.translate(x, y);
    if (picked) {
      context.beginPath();
      context.arc(0, 0, MARK_PX + 6, 0, 2 * Math.PI);
      context.strokeStyle = "#fff";
      context.lineWidth = 5;
      context.stroke();
      context.strokeStyle = "#111";
      context.lineWidth = 2;
      context.stroke();
    }
    context.lineWidth = filled(state) ? 2.6 : 4.6;
    context.strokeStyle = "rgb(255 255 255 / 0.92)";
    context.stroke(path);
    if (filled(state)) {
      context.fillStyle = stateColour[state];
      context.fill(path);
      context.lineWidth = 0.9;
      context.strokeStyle = "rgb(0 0 0 / 0.75)";
      context.stroke(path);
    } else {
      context.lineWidth = 1.9;
      context.strokeStyle = "#55595e";
      context.stroke(path);
    }
    if (turn !== undefined) this.text(String(turn + 1), 0, 0.5, state === "next" ? "#fff" : "#111");
    else if (state === "done") this.text("✓", 0, 0.5, "#fff");
    context.restore();
    if (picked) this.label(`G${goal}`, x, y - MARK_PX - 15);
  }

  private text(words: string, x: number, y: number, colour: string): void {
    const { context } = this;
    context.font = `600 ${words.length > 1 ? 9.5 : 10.5}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = colour;
    context.fillText(words, x, y);
  }

  private label(words: string, x: number, y: number): void {
    const { context } = this;
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineWidth = 4;
    context.strokeStyle = "rgb(255 255 255 / 0.95)";
    context.strokeText(words, x, y);
    context.fillStyle = "#111";
    context.fillText(words, x, y);
  }

  private rover(moment: Moment): void {
    const { context } = this;
    const { x, y } = this.place(moment.pose);
    context.save();
    context.translate(x, y);
    // Headings turn clockwise from north, as the canvas does from its top.
    context.rotate(moment.headingRad);
    const arrow = new Path2D("M0 -10L7.5 8L0 4.2L-7.5 8Z");
    context.lineJoin = "round";
    context.lineWidth = 4.5;
    context.strokeStyle = "#fff";
    context.stroke(arrow);
    context.fillStyle = "#111";
    context.fill(arrow);
    context.restore();
  }

  private crosshair(cell: Cell): void {
    const { context } = this;
    const size = Math.max(this.scale, 5);
    const { x, y } = this.place(cell);
    context.lineWidth = 3;
    context.strokeStyle = "rgb(255 255 255 / 0.9)";
    context.strokeRect(x - size / 2, y - size / 2, size, size);
    context.lineWidth = 1.2;
    context.strokeStyle = "#111";
    context.strokeRect(x - size / 2, y - size / 2, size, size);
  }

  /** The cell under a pixel of the canvas. */
  private cellAt(px: number, py: number): Cell | undefined {
    const grid = this.scene?.run.facts.grid;
    const cell = { row: Math.floor((py - this.y) / this.scale), col: Math.floor((px - this.x) / this.scale) };
    const inside = grid && cell.row >= 0 && cell.col >= 0 && cell.row < grid.rows && cell.col < grid.cols;
    return inside ? cell : undefined;
  }

  private goalAt(px: number, py: number): number | undefined {
    const near = this.marks
      .map((mark) => {
        const { x, y } = this.place(mark.cell);
        return { goal: mark.goal, away: Math.hypot(px - x, py - y) };
      })
      .filter(({ away }) => away <= REACH_PX);
    // The mark on top is the last drawn; of equals it wins.
    return near.reverse().sort((a, b) => a.away - b.away)[0]?.goal;
  }

  private listen(): void {
    const { canvas } = this;
    let from: { x: number; y: number; moved: boolean } | undefined;
    let wiping = false;
    const onWipe = (x: number): boolean => {
      const { other } = this.scene ?? {};
      return other !== undefined && Math.abs(x - other.wipe * canvas.clientWidth) < WIPE_REACH_PX;
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (onWipe(event.offsetX)) {
        wiping = true;
        canvas.setPointerCapture(event.pointerId);
        return;
      }
      from = { x: event.offsetX, y: event.offsetY, moved: false };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (wiping) {
        this.handlers.wipe(Math.min(1, Math.max(0, event.offsetX / canvas.clientWidth)));
        return;
      }
      if (from) {
        const [dx, dy] = [event.offsetX - from.x, event.offsetY - from.y];
        if (!from.moved && Math.hypot(dx, dy) < 4) return;
        this.pan(dx, dy);
        from = { x: event.offsetX, y: event.offsetY, moved: true };
        return;
      }
      this.handlers.probe(this.cellAt(event.offsetX, event.offsetY));
      if (onWipe(event.offsetX)) canvas.style.cursor = "ew-resize";
      else canvas.style.cursor = this.goalAt(event.offsetX, event.offsetY) === undefined ? "crosshair" : "pointer";
    });
    canvas.addEventListener("pointerup", (event) => {
      if (from && !from.moved) this.handlers.pick(this.goalAt(event.offsetX, event.offsetY));
      from = undefined;
      wiping = false;
    });
    canvas.addEventListener("pointerleave", () => this.handlers.probe(undefined));
    canvas.addEventListener("dblclick", () => this.fit());
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** On the focused map: + and −, 0, Shift and arrows to pan, Alt and arrows to ask about a cell. */
  private key(event: KeyboardEvent): void {
    const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (event.key === "+" || event.key === "=") this.zoom(ZOOM_STEP);
    else if (event.key === "-") this.zoom(1 / ZOOM_STEP);
    else if (event.key === "0") this.fit();
    else if (arrow && event.shiftKey) this.pan(-40 * arrow[0], -40 * arrow[1]);
    else if (arrow && event.altKey) this.step(arrow);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private step([dx, dy]: [number, number]): void {
    const { scene } = this;
    const from = scene?.probe ?? scene?.run.moment(scene.index)?.pose;
    if (!scene || !from) return;
    const { rows, cols } = scene.run.facts.grid;
    const within = (value: number, size: number): number => Math.min(size - 1, Math.max(0, value));
    this.handlers.probe({ row: within(from.row + dy, rows), col: within(from.col + dx, cols) });
  }
}
