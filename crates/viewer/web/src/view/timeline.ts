// The timeline: seen, scrubbed, scrolled and asked.

import type { Life } from "../model/lives";
import type { Run } from "../model/run";
import { stateLabel, stateOf } from "../model/states";
import { clock, goalName, reason } from "../ui/format";
import { FlatSurface, token } from "./canvas";
import { CanvasInk, SvgInk } from "./ink";
import { LEFT, drawTimeline, lanesOf, rowsOf, scaleOf } from "./lanes";
import type { Colours, Lane, TimelineScene } from "./lanes";

export interface TimelineHandlers {
  /** To a decision of the first run or of the second. */
  seek(index: number, of: "a" | "b"): void;
  pick(goal: number, of: "a" | "b"): void;
  hint(text: string | undefined, x: number, y: number): void;
}

/** How near the pointer must come to an event. */
const REACH_PX = 7;
const ROW_REACH_PX = 8;
/** A figure that is saved is at least this wide. */
const FIGURE_WIDTH = 1100;
/** What the key takes. */
const KEY_HEIGHT = 170;

const colours = (): Colours => ({
  ink: token("--ink"),
  faint: token("--ink-3"),
  rule: token("--rule"),
  scroll: token("--rule-2"),
  panel: token("--panel"),
  picked: token("--picked"),
  accent: token("--accent"),
});

/** On paper: as the light theme has them. */
const PAPER: Colours = { ink: "#1a1c1f", faint: "#4c5157", rule: "#e5e3dd", scroll: "#c9c7c0", panel: "#ffffff", picked: "#e6f0f7", accent: "#0a63a3" };

export class TimelineView {
  private readonly surface: FlatSurface;
  private readonly ink: CanvasInk;
  private scene: TimelineScene | undefined;
  private lanes: readonly Lane[] = [];
  private lanesFrom = "";
  private scrolled = 0;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly handlers: TimelineHandlers,
  ) {
    this.surface = new FlatSurface(
      canvas,
      (size) => this.draw(size),
      () => this.scroll(0),
    );
    this.ink = new CanvasInk(this.surface.context);
    this.listen();
  }

  show(scene: TimelineScene): void {
    const picked = scene.goal !== undefined && scene.goal !== this.scene?.goal;
    const another = this.scene?.run !== scene.run || this.scene.other?.run !== scene.other?.run;
    this.scene = scene;
    const from = `${scene.run.moments.length}/${scene.other?.run.moments.length}`;
    if (another || from !== this.lanesFrom) {
      this.lanes = lanesOf(scene);
      this.lanesFrom = from;
      this.scroll(0);
    }
    if (picked) this.reveal(scene.goal ?? -1);
    this.redraw();
  }

  redraw(): void {
    this.surface.redraw();
  }

  /** The whole of it, all lanes, to stand without this page. */
  figure(label: string): SVGSVGElement | undefined {
    return this.figures(label, Math.max(FIGURE_WIDTH, this.canvas.clientWidth), Number.POSITIVE_INFINITY)[0];
  }

  /** In as many pieces as it takes for none to be higher than this; each has the axis. */
  figures(label: string, width: number, height: number): SVGSVGElement[] {
    const { scene } = this;
    if (!scene) return [];
    const rows = rowsOf(scene);
    const each = Math.max(1, Math.min(this.lanes.length, Math.floor((height - rows.lanes - 8) / rows.lane)));
    const pieces = Math.max(1, Math.ceil(this.lanes.length / each));
    return Array.from({ length: pieces }, (_, i) => {
      const lanes = this.lanes.slice(i * each, (i + 1) * each);
      const size = { width, height: Math.max(KEY_HEIGHT, rows.lanes + lanes.length * rows.lane + 8) };
      const ink = new SvgInk(size.width, size.height, PAPER.panel, label);
      drawTimeline(ink, scene, lanes, size, 0, PAPER);
      return ink.svg;
    });
  }

  private draw(size: { width: number; height: number }): void {
    const { scene } = this;
    if (scene && scene.run.moments.length > 0) drawTimeline(this.ink, scene, this.lanes, size, this.scrolled, colours());
  }

  private scroll(dy: number): void {
    const { scene } = this;
    if (!scene) return;
    const rows = rowsOf(scene);
    const most = Math.max(0, this.lanes.length * rows.lane - (this.canvas.clientHeight - rows.lanes) + 4);
    this.scrolled = Math.min(most, Math.max(0, this.scrolled + dy));
    this.redraw();
  }

  private reveal(goal: number): void {
    const { scene } = this;
    const lane = this.lanes.findIndex((lane) => lane[this.scene?.lead ?? "a"]?.goal === goal);
    if (lane < 0 || !scene) return;
    const rows = rowsOf(scene);
    const room = this.canvas.clientHeight - rows.lanes;
    const y = lane * rows.lane;
    if (y < this.scrolled || y + rows.lane > this.scrolled + room) this.scroll(y - room / 2 - this.scrolled);
  }

  /** The lane under a pixel, and which run's half of it. */
  private laneAt(py: number): { lane: Lane; b: boolean } | undefined {
    const { scene } = this;
    if (!scene) return undefined;
    const rows = rowsOf(scene);
    const y = py - rows.lanes + this.scrolled;
    const lane = py < rows.lanes ? undefined : this.lanes[Math.floor(y / rows.lane)];
    return lane && { lane, b: scene.other !== undefined && y % rows.lane > rows.lane / 2 };
  }

  /** The run that a row tells of; none between them. */
  private sideAt(py: number): "a" | "b" | undefined {
    const { scene } = this;
    if (!scene?.other) return "a";
    const at = this.laneAt(py);
    if (at) return at.b ? "b" : "a";
    const rows = rowsOf(scene);
    return (["a", "b"] as const).find((_, i) => [rows.decisions[i], rows.events[i]].some((y) => y !== undefined && Math.abs(py - y) < ROW_REACH_PX));
  }

  private hintAt(px: number, py: number): string | undefined {
    const { scene } = this;
    if (!scene || px < LEFT - 62) return undefined;
    const rows = rowsOf(scene);
    const at = this.laneAt(py);
    const runs = [scene.run, ...(scene.other ? [scene.other.run] : [])];
    const side = this.sideAt(py) === "b" ? 1 : 0;
    const run = runs[side];
    if (!run) return undefined;
    const name = scene.other ? `${side === 0 ? "A" : "B"}: ` : "";
    if (Math.abs(py - (rows.events[side] ?? 0)) < ROW_REACH_PX) {
      const event = this.eventAt(run, px);
      if (event) return name + event;
    }
    if (px < LEFT - 10 && !at) return undefined;
    const index = scaleOf(scene, this.canvas.clientWidth).indexAt(run, px);
    const moment = run.moments[index];
    if (!moment) return undefined;
    const life = at && (at.b ? at.lane.b : at.lane.a);
    return `${name}decision ${moment.number}, ${clock(moment.timeS)}${life ? ` · ${this.told(run, life, index)}` : ""}`;
  }

  /** What was said of a goal at a decision, or how it had ended by then. */
  private told(run: Run, life: Life, index: number): string {
    const [verdict, moment] = [run.verdict(index, life.goal), run.moment(index)];
    const named = `${goalName(life.goal)} ${life.directive}`;
    if (verdict && moment) return `${named}: ${stateLabel[stateOf(verdict, moment)]}, ${verdict.action}, ${reason(verdict)}`;
    if (index < life.first) return `${named}: not found yet`;
    return life.end ? `${named}: ${stateLabel[life.end.state]} since decision ${run.moment(life.end.at)?.number ?? life.end.at}` : named;
  }

  private eventAt(run: Run, px: number): string | undefined {
    const { scene } = this;
    if (!scene) return undefined;
    const scale = scaleOf(scene, this.canvas.clientWidth);
    let best: { away: number; text: () => string } | undefined;
    const near = (timeS: number, text: () => string): void => {
      const away = Math.abs(scale.xOf(run, timeS) - px);
      if (away < Math.min(REACH_PX, best?.away ?? REACH_PX)) best = { away, text };
    };
    for (const one of run.happenings) near(one.timeS, () => `${clock(one.timeS)} ${one.kind}: ${one.text}`);
    for (const { spent, result, goal, operators } of run.outcomes.values()) {
      near(spent.timeS, () => `${clock(spent.timeS)} ${result}${goal === undefined ? "" : ` ${goalName(goal)}`}${operators.length > 0 ? `; ${operators.join(", ")}` : ""}`);
    }
    return best?.text();
  }

  private listen(): void {
    const { canvas } = this;
    let dragging = false;
    let of: "a" | "b" = "a";
    const seek = (px: number): void => {
      const { scene } = this;
      if (scene) this.handlers.seek(scaleOf(scene, canvas.clientWidth).indexAt(of === "b" && scene.other ? scene.other.run : scene.run, px), of);
    };
    canvas.addEventListener("pointerdown", (event) => {
      of = this.sideAt(event.offsetY) ?? this.scene?.lead ?? "a";
      const goal = this.laneAt(event.offsetY)?.lane[of]?.goal;
      if (goal !== undefined) this.handlers.pick(goal, of);
      if (event.offsetX < LEFT - 10) return;
      dragging = true;
      canvas.setPointerCapture(event.pointerId);
      seek(event.offsetX);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (dragging) seek(event.offsetX);
      this.handlers.hint(this.hintAt(event.offsetX, event.offsetY), event.clientX, event.clientY);
    });
    const release = (): void => {
      dragging = false;
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("pointerleave", () => this.handlers.hint(undefined, 0, 0));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.scroll(event.deltaY);
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
      if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
      this.scroll(event.key === "ArrowUp" ? -20 : 20);
      event.preventDefault();
    });
  }
}
