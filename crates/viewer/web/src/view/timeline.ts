// The timeline: decisions, events, and a lane for the life of each goal.

import { lives } from "../model/lives";
import type { Life } from "../model/lives";
import type { Run } from "../model/run";
import type { Axis } from "../state";
import { clock, goalName } from "../ui/format";
import { FlatSurface } from "./canvas";
import type { Size } from "./canvas";
import { OKABE } from "./colour";
import { markPath2d, stateColour } from "./marks";

export interface TimelineScene {
  run: Run;
  index: number;
  axis: Axis;
  goal: number | undefined;
}

export interface TimelineHandlers {
  seek(index: number): void;
  pick(goal: number): void;
  hint(text: string | undefined, x: number, y: number): void;
}

const LEFT = 74;
const RIGHT = 112;
const AXIS_Y = 15;
const DECISIONS_Y = 33;
const EVENTS_Y = 51;
const LANES_Y = 66;
const LANE = 10;

/** Steps of an axis of hours and minutes, seconds. */
const STEPS_S = [60, 120, 300, 600, 900, 1800, 3600, 7200, 14_400, 21_600, 43_200, 86_400] as const;

const RESULTS: Record<string, { colour: string; shape: "square" | "ring" | "cross" }> = {
  achieved: { colour: OKABE.green, shape: "square" },
  arrived: { colour: OKABE.green, shape: "ring" },
  stopped: { colour: OKABE.grey, shape: "ring" },
  interrupted: { colour: OKABE.sky, shape: "ring" },
  blocked: { colour: OKABE.vermilion, shape: "cross" },
  aborted: { colour: OKABE.vermilion, shape: "cross" },
};

export class TimelineView {
  private readonly surface: FlatSurface;
  private readonly context: CanvasRenderingContext2D;
  private scene: TimelineScene | undefined;
  private lanes: Life[] = [];
  private lanesOf = -1;
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
    this.context = this.surface.context;
    this.listen();
  }

  show(scene: TimelineScene): void {
    if (this.scene?.run !== scene.run) this.lanesOf = -1;
    const picked = scene.goal !== undefined && scene.goal !== this.scene?.goal;
    this.scene = scene;
    if (this.lanesOf !== scene.run.moments.length) {
      this.lanes = lives(scene.run.moments);
      this.lanesOf = scene.run.moments.length;
    }
    if (picked) this.reveal(scene.goal ?? -1);
    this.redraw();
  }

  redraw(): void {
    this.surface.redraw();
  }

  /** Where a decision begins; the one after the last is where the log ends. */
  private x(index: number): number {
    const { scene } = this;
    if (!scene) return LEFT;
    const width = this.canvas.clientWidth - LEFT - RIGHT;
    const count = scene.run.moments.length;
    if (scene.axis === "decision") return LEFT + (width * index) / Math.max(1, count);
    return this.xOf(scene.run.moments[index]?.timeS ?? scene.run.endS);
  }

  private xOf(timeS: number): number {
    const { scene } = this;
    if (!scene) return LEFT;
    const width = this.canvas.clientWidth - LEFT - RIGHT;
    if (scene.axis === "time") return LEFT + (width * timeS) / Math.max(1, scene.run.endS);
    const index = scene.run.indexAt(timeS);
    const [from, to] = [scene.run.moments[index]?.timeS ?? 0, scene.run.moments[index + 1]?.timeS ?? scene.run.endS];
    const part = to > from ? Math.min(1, (timeS - from) / (to - from)) : 0;
    return this.x(index) + part * (this.x(index + 1) - this.x(index));
  }

  private draw({ height }: Size): void {
    const { context, scene } = this;
    if (!scene || scene.run.moments.length === 0) return;
    const style = getComputedStyle(document.documentElement);
    const token = (name: string): string => style.getPropertyValue(name).trim();
    const [ink, faint, rule] = [token("--ink"), token("--ink-3"), token("--rule")];
    this.lanesDrawn(scene, token, height);
    this.axis(scene, faint, rule, height);
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillStyle = faint;
    context.fillText("decisions", 10, DECISIONS_Y);
    context.fillText("events", 10, EVENTS_Y);
    this.decisions(scene, ink, faint, token("--panel"));
    this.events(scene);
    this.cursor(scene, token("--accent"), height);
  }

  private axis(scene: TimelineScene, faint: string, rule: string, height: number): void {
    const { context } = this;
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.textAlign = "center";
    const tick = (x: number, words: string): void => {
      context.strokeStyle = rule;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(Math.round(x) + 0.5, AXIS_Y + 8);
      context.lineTo(Math.round(x) + 0.5, height);
      context.stroke();
      context.fillStyle = faint;
      context.fillText(words, x, AXIS_Y);
    };
    const width = this.canvas.clientWidth - LEFT - RIGHT;
    if (scene.axis === "time") {
      const most = width / 74;
      const step = STEPS_S.find((one) => scene.run.endS / one <= most) ?? 86_400;
      for (let timeS = 0; timeS <= scene.run.endS; timeS += step) tick(this.xOf(timeS), clock(timeS).replace(" h", ""));
    } else {
      const count = scene.run.moments.length;
      const step = Math.max(1, Math.ceil((count * 30) / width));
      for (let i = 0; i < count; i += step) tick(this.x(i), String(scene.run.moments[i]?.number ?? i));
    }
    context.textAlign = "left";
    context.fillText(scene.axis === "time" ? "time, h" : "number", 10, AXIS_Y);
  }

  private decisions(scene: TimelineScene, ink: string, faint: string, panel: string): void {
    const { context } = this;
    scene.run.moments.forEach((moment, index) => {
      const x = this.x(index);
      context.beginPath();
      if (moment.act.name === "pursue") context.arc(x, DECISIONS_Y, 4, 0, 2 * Math.PI);
      else context.rect(x - 3.5, DECISIONS_Y - 3.5, 7, 7);
      const waits = moment.act.name === "wait";
      context.fillStyle = waits ? panel : index <= scene.index ? ink : faint;
      context.fill();
      context.lineWidth = 1.4;
      context.strokeStyle = waits ? ink : panel;
      context.stroke();
    });
  }

  private events(scene: TimelineScene): void {
    const { context } = this;
    for (const outcome of scene.run.outcomes.values()) {
      const look = RESULTS[outcome.result] ?? { colour: OKABE.grey, shape: "ring" as const };
      const x = this.xOf(outcome.spent.timeS);
      context.beginPath();
      context.lineWidth = 1.8;
      if (look.shape === "square") {
        context.fillStyle = look.colour;
        context.fillRect(x - 3.6, EVENTS_Y - 3.6, 7.2, 7.2);
      } else if (look.shape === "ring") {
        context.strokeStyle = look.colour;
        context.arc(x, EVENTS_Y, 3, 0, 2 * Math.PI);
        context.stroke();
      } else {
        context.save();
        context.translate(x, EVENTS_Y);
        context.strokeStyle = look.colour;
        context.stroke(markPath2d("dropped", 5));
        context.restore();
      }
    }
    for (const happening of scene.run.happenings) {
      const x = this.xOf(happening.timeS);
      context.fillStyle = happening.kind === "fault" ? OKABE.vermilion : OKABE.pink;
      context.beginPath();
      context.moveTo(x, EVENTS_Y - 5);
      context.lineTo(x + 5, EVENTS_Y + 4);
      context.lineTo(x - 5, EVENTS_Y + 4);
      context.fill();
    }
  }

  private lanesDrawn(scene: TimelineScene, token: (name: string) => string, height: number): void {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(0, LANES_Y - 4, this.canvas.clientWidth, height - LANES_Y + 4);
    context.clip();
    context.textBaseline = "middle";
    this.lanes.forEach((life, lane) => {
      const y = LANES_Y + lane * LANE - this.scrolled + LANE / 2;
      if (y < LANES_Y - LANE || y > height + LANE) return;
      const picked = life.goal === scene.goal;
      if (picked) {
        context.fillStyle = token("--picked");
        context.fillRect(0, y - LANE / 2, this.canvas.clientWidth, LANE);
      }
      context.font = `${picked ? "600 " : ""}9.5px system-ui, sans-serif`;
      context.textAlign = "right";
      context.fillStyle = picked ? token("--ink") : token("--ink-3");
      context.fillText(goalName(life.goal), LEFT - 12, y + 0.5);
      for (const { state, from, to } of life.stretches) {
        const [x0, x1] = [this.x(from), this.x(to)];
        const thick = state === "next" ? 7 : state === "planned" ? 4.5 : 2;
        context.fillStyle = stateColour[state];
        context.fillRect(x0, y - thick / 2, Math.max(1.5, x1 - x0), thick);
      }
      if (!life.end) return;
      context.save();
      context.translate(this.x(life.end.at), y);
      const path = markPath2d(life.end.state, 4.6);
      if (life.end.state === "done") {
        context.fillStyle = stateColour.done;
        context.fill(path);
      } else {
        context.strokeStyle = token("--ink-3");
        context.lineWidth = 1.6;
        context.stroke(path);
      }
      context.restore();
    });
    const all = this.lanes.length * LANE;
    const room = height - LANES_Y;
    if (all > room) {
      context.fillStyle = token("--rule-2");
      context.fillRect(this.canvas.clientWidth - RIGHT + 12, LANES_Y + (this.scrolled / all) * room, 3, (room / all) * room);
    }
    context.restore();
  }

  private cursor(scene: TimelineScene, accent: string, height: number): void {
    const { context } = this;
    const x = this.x(scene.index);
    context.strokeStyle = accent;
    context.lineWidth = 1.6;
    context.beginPath();
    context.moveTo(x, AXIS_Y + 6);
    context.lineTo(x, height);
    context.stroke();
    context.beginPath();
    context.arc(x, DECISIONS_Y, 6.5, 0, 2 * Math.PI);
    context.lineWidth = 2.4;
    context.stroke();
  }

  private scroll(dy: number): void {
    const most = Math.max(0, this.lanes.length * LANE - (this.canvas.clientHeight - LANES_Y) + 4);
    this.scrolled = Math.min(most, Math.max(0, this.scrolled + dy));
    this.redraw();
  }

  private reveal(goal: number): void {
    const lane = this.lanes.findIndex((life) => life.goal === goal);
    if (lane < 0) return;
    const room = this.canvas.clientHeight - LANES_Y;
    const y = lane * LANE;
    if (y < this.scrolled || y + LANE > this.scrolled + room) this.scroll(y - room / 2 - this.scrolled);
  }

  /** The decision under a pixel: the nearest by x. */
  private indexAt(px: number): number {
    const count = this.scene?.run.moments.length ?? 0;
    let best = 0;
    for (let i = 1; i < count; i++) if (Math.abs(this.x(i) - px) < Math.abs(this.x(best) - px)) best = i;
    return best;
  }

  private laneAt(py: number): Life | undefined {
    return py < LANES_Y ? undefined : this.lanes[Math.floor((py - LANES_Y + this.scrolled) / LANE)];
  }

  private hintAt(px: number, py: number): string | undefined {
    const { scene } = this;
    if (!scene) return undefined;
    if (Math.abs(py - EVENTS_Y) < 8) {
      const near = <T>(all: Iterable<T>, time: (one: T) => number): T | undefined =>
        [...all].filter((one) => Math.abs(this.xOf(time(one)) - px) < 7).sort((a, b) => Math.abs(this.xOf(time(a)) - px) - Math.abs(this.xOf(time(b)) - px))[0];
      const happening = near(scene.run.happenings, (one) => one.timeS);
      if (happening) return `${clock(happening.timeS)} ${happening.kind}: ${happening.text}`;
      const outcome = near(scene.run.outcomes.values(), (one) => one.spent.timeS);
      if (outcome) return `${clock(outcome.spent.timeS)} ${outcome.result}${outcome.goal === undefined ? "" : ` ${goalName(outcome.goal)}`}`;
    }
    const moment = scene.run.moments[this.indexAt(px)];
    if (!moment || px < LEFT - 10) return undefined;
    const life = this.laneAt(py);
    const said = life && moment.verdicts.find((verdict) => verdict.goal.id === life.goal);
    const goal = said ? ` · ${goalName(said.goal.id)} ${said.action}, ${said.reason}` : life ? ` · ${goalName(life.goal)}` : "";
    return `decision ${moment.number}, ${clock(moment.timeS)}${goal}`;
  }

  private listen(): void {
    const { canvas } = this;
    let dragging = false;
    const seek = (px: number): void => this.handlers.seek(this.indexAt(px));
    canvas.addEventListener("pointerdown", (event) => {
      const life = this.laneAt(event.offsetY);
      if (life) this.handlers.pick(life.goal);
      if (event.offsetX < LEFT - 10) return;
      dragging = true;
      canvas.setPointerCapture(event.pointerId);
      seek(event.offsetX);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (dragging) seek(event.offsetX);
      this.handlers.hint(this.hintAt(event.offsetX, event.offsetY), event.clientX, event.clientY);
    });
    canvas.addEventListener("pointerup", () => {
      dragging = false;
    });
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
      this.scroll(event.key === "ArrowUp" ? -LANE * 2 : LANE * 2);
      event.preventDefault();
    });
  }
}
