// Numbers over the run: what the chosen plan was worth and how sure it was, and the energy spent.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";

import type { Run } from "../model/run";
import { OKABE } from "./colour";

const HEIGHT = 190;

export class Trend {
  private plot: uPlot | undefined;
  private of = "";
  private index = 0;

  constructor(
    private readonly place: HTMLElement,
    private readonly seek: (index: number) => void,
  ) {}

  show(run: Run, index: number): void {
    this.index = index;
    const width = Math.max(300, this.place.clientWidth);
    const ink = getComputedStyle(document.documentElement).getPropertyValue("color-scheme");
    const of = `${run.moments.length}/${width}/${ink}${matchMedia("(prefers-color-scheme: dark)").matches}`;
    if (this.of === of) {
      this.plot?.redraw(false);
      this.plot?.setLegend({ idx: index });
      return;
    }
    this.of = of;
    this.plot?.destroy();
    this.plot = new uPlot(this.options(width), this.data(run), this.place);
    this.plot.setLegend({ idx: index });
  }

  private data(run: Run): uPlot.AlignedData {
    const chosen = run.moments.map((moment) => moment.family[moment.chosen]);
    return [
      run.moments.map(({ timeS }) => timeS / 3600),
      chosen.map((one) => one?.value ?? null),
      chosen.map((one) => (one && one.order.length > 0 ? one.reliability : null)),
      run.moments.map(({ spent }) => spent.energyJ / 1e6),
    ];
  }

  private options(width: number): uPlot.Options {
    const style = getComputedStyle(this.place);
    const [ink, rule] = [style.getPropertyValue("--trend-ink") || style.color, style.getPropertyValue("border-color")];
    const axis = (scale: string, side: 1 | 3, label: string, grid: boolean): uPlot.Axis => ({
      scale,
      side,
      label,
      stroke: ink,
      size: 44,
      labelSize: 16,
      font: "11px system-ui, sans-serif",
      labelFont: "11px system-ui, sans-serif",
      grid: { show: grid, stroke: rule, width: 1 },
      ticks: { show: false },
    });
    const line = (label: string, scale: string, stroke: string, dash?: number[]): uPlot.Series => ({ label, scale, stroke, width: 2, dash, points: { size: 5, fill: stroke } });
    return {
      width,
      height: HEIGHT,
      legend: { show: true, live: true },
      cursor: { y: false, drag: { x: false, y: false } },
      scales: { x: { time: false }, reliability: { range: (_, min) => [Math.min(0.5, Math.floor(10 * (min ?? 0.5)) / 10), 1] }, value: {}, energy: {} },
      series: [
        { label: "hours", value: (_, hours) => (hours === null ? "" : `${hours.toFixed(2)} h`) },
        { ...line("value", "value", OKABE.orange), value: (_, v) => (v === null ? "" : v.toFixed(3)) },
        { ...line("reliability", "reliability", OKABE.blue, [6, 3]), value: (_, v) => (v === null ? "" : v.toFixed(4)) },
        { ...line("energy spent, MJ", "energy", OKABE.green, [2, 3]), value: (_, v) => (v === null ? "" : v.toFixed(2)) },
      ],
      axes: [
        { stroke: ink, font: "11px system-ui, sans-serif", grid: { stroke: rule, width: 1 }, ticks: { show: false }, size: 26 },
        axis("value", 3, "value", true),
        axis("reliability", 1, "reliability", false),
      ],
      hooks: {
        draw: [(plot) => this.cursor(plot)],
        ready: [(plot) => plot.over.addEventListener("click", () => typeof plot.cursor.idx === "number" && this.seek(plot.cursor.idx))],
      },
    };
  }

  /** The decision shown. */
  private cursor(plot: uPlot): void {
    const hours = plot.data[0][this.index];
    if (hours === undefined) return;
    const x = plot.valToPos(hours, "x", true);
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.setLineDash([]);
    ctx.strokeStyle = OKABE.vermilion;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }
}
