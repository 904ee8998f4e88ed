// The trends of a run as a figure to be saved or printed: value, reliability and energy over mission time.

import type { Run } from "../model/run";
import { OKABE } from "./colour";
import { tickLabel, ticks } from "./family";
import { SvgInk } from "./ink";

const WIDTH = 760;
const HEIGHT = 300;
const BOX = { left: 56, right: 66, top: 34, bottom: 40 };
const INK = "#444";

interface Line {
  label: string;
  colour: string;
  dash: readonly number[];
  values: readonly (number | undefined)[];
  from: number;
  to: number;
}

const spread = (values: readonly (number | undefined)[], least: number): [number, number] => {
  const known = values.filter((value) => value !== undefined);
  const [min, max] = [Math.min(least, ...known), Math.max(least, ...known)];
  return [min, max > min ? max : min + 1];
};

/** What is shown over the run: one number a decision, and where each has its axis. */
export const trendFigure = (run: Run, label: string): SVGSVGElement => {
  const ink = new SvgInk(WIDTH, HEIGHT, "#ffffff", label);
  const chosen = run.moments.map((moment) => moment.family[moment.chosen]);
  const hours = run.moments.map(({ timeS }) => timeS / 3600);
  const values = chosen.map((one) => one?.value);
  const energy = run.moments.map(({ spent }) => spent.energyJ / 1e6);
  const sure = chosen.map((one) => (one && one.order.length > 0 ? one.reliability : undefined));
  const [low, high] = spread(values, 0);
  const floor = Math.min(0.5, Math.floor(10 * Math.min(0.5, ...sure.filter((one) => one !== undefined))) / 10);
  const [spentFrom, spentTo] = spread(energy, 0);
  const lines: Line[] = [
    { label: "value (left)", colour: OKABE.orange, dash: [], values, from: low, to: high * 1.05 },
    { label: "reliability (right)", colour: OKABE.blue, dash: [6, 3], values: sure, from: floor, to: 1 },
    { label: `energy spent, of ${spentTo.toFixed(2)} MJ`, colour: OKABE.green, dash: [2, 3], values: energy, from: spentFrom, to: spentTo },
  ];
  const end = Math.max(1e-9, ...hours);
  const x = (hour: number): number => BOX.left + (hour / end) * (WIDTH - BOX.left - BOX.right);
  const y = ({ from, to }: Line, value: number): number => HEIGHT - BOX.bottom - ((value - from) / (to - from)) * (HEIGHT - BOX.top - BOX.bottom);
  axes(ink, lines, end, x, y);
  for (const line of lines) draw(ink, line, hours, x, y);
  lines.forEach((line, i) => {
    const at = BOX.left + i * 190;
    ink.line(at, 16, at + 24, 16, { stroke: line.colour, width: 2, dash: line.dash });
    ink.text(line.label, at + 30, 16, { size: 11, fill: INK, anchor: "start" });
  });
  return ink.svg;
};

const axes = (ink: SvgInk, lines: readonly Line[], end: number, x: (hour: number) => number, y: (line: Line, value: number) => number): void => {
  const letters = { size: 11, fill: INK };
  const hours = ticks(0, end);
  for (const hour of hours) {
    ink.line(x(hour), BOX.top, x(hour), HEIGHT - BOX.bottom, { stroke: "#ddd" });
    ink.text(tickLabel(hour, hours), x(hour), HEIGHT - BOX.bottom + 14, { ...letters, anchor: "middle" });
  }
  ink.text("mission time, h", WIDTH - BOX.right, HEIGHT - 10, { ...letters, anchor: "end" });
  lines.slice(0, 2).forEach((line, side) => {
    const all = ticks(line.from, line.to);
    for (const value of all) {
      if (side === 0) ink.line(BOX.left, y(line, value), WIDTH - BOX.right, y(line, value), { stroke: "#eee" });
      ink.text(tickLabel(value, all), side === 0 ? BOX.left - 6 : WIDTH - BOX.right + 6, y(line, value), { ...letters, fill: line.colour, anchor: side === 0 ? "end" : "start" });
    }
  });
};

/** Dots where decisions are, joined where both know a number. */
const draw = (ink: SvgInk, line: Line, hours: readonly number[], x: (hour: number) => number, y: (line: Line, value: number) => number): void => {
  const paint = { stroke: line.colour, width: 2, dash: line.dash };
  hours.forEach((hour, i) => {
    const [was, is] = [line.values[i - 1], line.values[i]];
    if (is === undefined) return;
    if (was !== undefined) ink.line(x(hours[i - 1] ?? hour), y(line, was), x(hour), y(line, is), paint);
    if (hours.length < 400) ink.circle(x(hour), y(line, is), 2.2, { fill: line.colour });
  });
};
