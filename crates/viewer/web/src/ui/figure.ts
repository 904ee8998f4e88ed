// The map as a figure that stands without this page: SVG, with the ground as a picture inside, and all else as lines and
// words; and PNG made of it.

import type { Cell } from "../model/types";
import type { Panel } from "../view/map";
import { filled, MARK_PX, markPath, markRadius, markText, stateColour } from "../view/marks";
import { ROVER_PATH } from "../view/shapes";
import type { Mark, Shape, Way } from "../view/shapes";
import { colourTable, css } from "../view/colour";
import { s } from "./dom";
import { classColours, tickLabels, WAY_COLOURS } from "./legend";
import { stateLabel } from "../model/states";
import type { LegendWords } from "./legend";

/** What a figure is made of. */
export interface Figure {
  title: string;
  /** What it was made of. */
  source: string;
  panels: readonly Panel[];
  height: number;
  metresPerPixel: number;
  legend: LegendWords | undefined;
  /** Where a line divides two runs. */
  divide: number | undefined;
  /** Whether they stand on other ground. */
  apart: boolean;
}

type Place = (cell: Cell) => { x: number; y: number };

const TITLE_PX = 44;
const LEGEND_PX = 126;
const RAMP_PX = 260;
/** Room of one name in the legend. */
const ENTRY_PX = 86;
/** Lengths of scale bars, metres. */
const BARS_M = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000] as const;
const LONGEST_BAR_PX = 150;

export const figureSvg = (figure: Figure): SVGSVGElement => {
  const { panels, height } = figure;
  const last = panels.at(-1);
  const width = last ? last.x + last.width : 0;
  // Only what shows ground, with a little air about it.
  const [left, right] = extent(figure, width);
  const top = Math.max(0, Math.min(...panels.map(({ viewport }) => viewport.y)) - 8);
  const bottom = Math.min(height, Math.max(...panels.map(({ viewport, side }) => viewport.y + side.run.facts.grid.rows * viewport.scale)) + 8);
  const across = Math.max(right - left, RAMP_PX + LONGEST_BAR_PX + 60);
  const down = bottom - top;
  const whole = { width: across, height: TITLE_PX + down + LEGEND_PX };
  const svg = s("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: `0 0 ${n(whole.width)} ${n(whole.height)}`, width: n(whole.width), height: n(whole.height), "font-family": "system-ui, sans-serif", "font-size": 12 });
  svg.append(
    s("title", {}, figure.title),
    s("rect", { width: "100%", height: "100%", fill: "#fff" }),
    s("text", { x: 8, y: 20, "font-size": 13.5, "font-weight": 600, fill: "#1a1c1f" }, figure.title),
    s("text", { x: 8, y: 36, "font-size": 11, fill: "#6d7279" }, figure.source),
  );
  const map = s("g", { transform: `translate(${n(-left)} ${n(TITLE_PX - top)})` });
  panels.forEach((panel, i) => map.append(...drawPanel(panel, `part-${i}`, { top, down, from: Math.max(left, panel.x), to: Math.min(right, panel.x + panel.width) })));
  if (figure.divide !== undefined) map.append(...divider(figure.divide, top, down, figure.apart));
  svg.append(map, legendOf(figure, across, TITLE_PX + down));
  return svg;
};

/** The PNG of a figure, so many pixels to a point. */
export const figurePng = async (svg: SVGSVGElement, ratio: number): Promise<Blob> => {
  const url = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(svg)], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [Math.round(image.width * ratio), Math.round(image.height * ratio)];
    canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise((resolve, reject) => canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the picture could not be made"))), "image/png"));
  } finally {
    URL.revokeObjectURL(url);
  }
};

/** Two decimals are finer than any screen. */
const n = (value: number): string => String(Math.round(value * 100) / 100);

const extent = ({ panels }: Figure, width: number): [number, number] => {
  const [first, last] = [panels[0], panels.at(-1)];
  if (!first || !last) return [0, width];
  const reach = last.viewport.x + last.dx + last.side.run.facts.grid.cols * last.viewport.scale;
  return [Math.max(0, first.viewport.x + first.dx - 8), Math.min(width, reach + 8)];
};

const drawPanel = (panel: Panel, id: string, part: { top: number; down: number; from: number; to: number }): SVGElement[] => {
  const { side, dx, picture, shapes, viewport } = panel;
  const { grid } = side.run.facts;
  const { scale, x, y } = viewport;
  const place: Place = (cell) => viewport.place(cell);
  const clip = s("clipPath", { id }, s("rect", { x: n(part.from), y: n(part.top), width: n(Math.max(0, part.to - part.from)), height: n(part.down) }));
  const moved = s("g", { transform: `translate(${n(dx)} 0)` }, s("rect", { x: n(x), y: n(y), width: n(grid.cols * scale), height: n(grid.rows * scale), fill: "#dcdad4", stroke: "#a9a7a1" }));
  const { plane } = side;
  if (plane && picture) {
    moved.append(
      s("image", {
        href: picture.toDataURL("image/png"),
        x: n(x + plane.col * scale),
        y: n(y + plane.row * scale),
        width: n(plane.cols * scale),
        height: n(plane.rows * scale),
        preserveAspectRatio: "none",
        style: "image-rendering: pixelated",
      }),
    );
  }
  moved.append(...shapes.flatMap((shape) => drawShape(shape, place)));
  return [clip, s("g", { "clip-path": `url(#${id})` }, moved)];
};

const drawShape = (shape: Shape, place: Place): SVGElement[] => {
  if (shape.kind === "way") return way(shape, place);
  const { x, y } = place(shape.cell);
  if (shape.kind === "dot") return [s("circle", { cx: n(x), cy: n(y), r: 3.2, fill: shape.colour, stroke: "#fff", "stroke-width": 1.2 })];
  if (shape.kind === "rover") {
    const turn = `translate(${n(x)} ${n(y)}) rotate(${n((shape.headingRad * 180) / Math.PI)})`;
    return [s("path", { d: ROVER_PATH, transform: turn, fill: "#111", stroke: "#fff", "stroke-width": 4.5, "stroke-linejoin": "round", "paint-order": "stroke" }, s("title", {}, "rover"))];
  }
  return [mark(shape, x, y)];
};

const way = ({ what, lines, colour, width, dash, opacity, casing }: Way, place: Place): SVGElement[] => {
  const d = lines.map((cells) => cells.map((cell, i) => `${i === 0 ? "M" : "L"}${n(place(cell).x)} ${n(place(cell).y)}`).join("")).join("");
  if (d === "") return [];
  const line = { d, fill: "none", "stroke-linejoin": "round", "stroke-linecap": dash.length > 0 ? "butt" : "round" };
  return [
    s("path", { ...line, stroke: "#fff", "stroke-opacity": casing, "stroke-width": width + 2.2 }),
    s("path", { ...line, class: what.replaceAll(" ", "-"), stroke: colour, "stroke-opacity": opacity, "stroke-width": width, "stroke-dasharray": dash.length > 0 ? dash.join(" ") : undefined }),
  ];
};

const mark = (shape: Mark, x: number, y: number): SVGElement => {
  const { state, goal, picked } = shape;
  const d = markPath(state, markRadius(state));
  const group = s("g", { transform: `translate(${n(x)} ${n(y)})`, class: `goal ${state}` }, s("title", {}, `G${goal}`));
  if (picked) group.append(...[["#fff", 5], ["#111", 2]].map(([stroke, width]) => s("circle", { r: MARK_PX + 6, fill: "none", stroke, "stroke-width": width })));
  group.append(s("path", { d, fill: "none", stroke: "#fff", "stroke-opacity": 0.92, "stroke-width": filled(state) ? 2.6 : 4.6 }));
  group.append(filled(state) ? s("path", { d, fill: stateColour[state], stroke: "#000", "stroke-opacity": 0.75, "stroke-width": 0.9 }) : s("path", { d, fill: "none", stroke: "#55595e", "stroke-width": 1.9 }));
  const words = markText(shape);
  if (words) group.append(s("text", { y: 3.8, "text-anchor": "middle", "font-size": words.text.length > 1 ? 9.5 : 10.5, "font-weight": 600, fill: words.colour }, words.text));
  // On paper nobody can point at a mark to learn its name.
  if (picked || state === "next" || state === "planned") group.append(haloed(`G${goal}`, 0, -MARK_PX - (picked ? 11 : 5)));
  return group;
};

/** Words that can be read on any ground. */
const haloed = (words: string, x: number, y: number): SVGElement =>
  s("text", { x: n(x), y: n(y), "text-anchor": "middle", "font-weight": 600, fill: "#111", stroke: "#fff", "stroke-width": 4, "stroke-linejoin": "round", "paint-order": "stroke" }, words);

const divider = (x: number, top: number, down: number, apart: boolean): SVGElement[] => [
  ...[["#fff", 4], ["#111", 1.5]].map(([stroke, width]) => s("line", { x1: n(x), x2: n(x), y1: n(top), y2: n(top + down), stroke, "stroke-width": width })),
  haloed("A", x - 14, top + 18),
  haloed(apart ? "B, other ground" : "B", x + (apart ? 58 : 14), top + 18),
];

/** The legend, and the scale bar below it on the right. */
const legendOf = ({ legend, metresPerPixel }: Figure, width: number, top: number): SVGElement => {
  const group = s("g", { transform: `translate(8 ${n(top + 18)})`, fill: "#1a1c1f" });
  if (legend) group.append(s("text", { "font-weight": 600 }, legend.title), ...(legend.scale.classes ? classes(legend, width) : ramp(legend)), ...ways(legend), ...marks(legend), s("text", { y: 86, "font-size": 10.5, fill: "#6d7279" }, [...legend.notes, ...legend.cautions].join("; ")));
  const bar = [...BARS_M].reverse().find((metres) => metres / metresPerPixel <= LONGEST_BAR_PX) ?? BARS_M[0];
  const length = bar / metresPerPixel;
  const from = width - 24 - length;
  group.append(
    s("path", { d: `M${n(from)} 94V100H${n(from + length)}V94`, fill: "none", stroke: "#1a1c1f", "stroke-width": 1.5 }),
    s("text", { x: n(from - 6), y: 102, "text-anchor": "end" }, `${bar} m`),
  );
  return group;
};

const ramp = ({ scale }: LegendWords): SVGElement[] => {
  const table = colourTable(scale.colours);
  const steps = 24;
  const stops = Array.from({ length: steps + 1 }, (_, i) => s("stop", { offset: n(i / steps), "stop-color": css(table, i / steps) }));
  const labels = tickLabels(scale);
  return [
    s("linearGradient", { id: "ramp" }, ...stops),
    s("rect", { y: 8, width: RAMP_PX, height: 10, fill: "url(#ramp)" }),
    ...labels.map((label, i) => s("text", { x: n((RAMP_PX * i) / (labels.length - 1)), y: 31, "font-size": 10.5, "text-anchor": i === 0 ? "start" : i === labels.length - 1 ? "end" : "middle" }, label)),
  ];
};

/** In as many rows as they need. */
const classes = (legend: LegendWords, width: number): SVGElement[] => {
  const across = Math.max(1, Math.floor((width - 16) / ENTRY_PX));
  return classColours(legend).flatMap(({ name, colour }, i) => {
    const [x, y] = [(i % across) * ENTRY_PX, 8 + 14 * Math.floor(i / across)];
    return [s("rect", { x, y, width: 11, height: 11, fill: colour }), s("text", { x: x + 15, y: y + 9.5, "font-size": 10.5 }, name)];
  });
};

/** The marks of goals by their states. */
const marks = ({ marks: shown }: LegendWords): SVGElement[] =>
  shown.flatMap((state, i) => {
    const sign = filled(state) ? { fill: stateColour[state], stroke: "#000", "stroke-opacity": 0.75, "stroke-width": 0.9 } : { fill: "none", stroke: "#55595e", "stroke-width": 1.9 };
    return [s("path", { d: markPath(state, 5.4), transform: `translate(${i * ENTRY_PX + 9} 65)`, ...sign }), s("text", { x: i * ENTRY_PX + 22, y: 69, "font-size": 10.5 }, stateLabel[state])];
  });

const ways = ({ ways: shown }: LegendWords): SVGElement[] =>
  shown.flatMap((what, i) => [s("line", { x1: i * ENTRY_PX, x2: i * ENTRY_PX + 18, y1: 46, y2: 46, stroke: WAY_COLOURS[what], ...(what === "pose to goal" ? { "stroke-width": 1.2, "stroke-dasharray": "2 2" } : { "stroke-width": 3 }) }), s("text", { x: i * ENTRY_PX + 22, y: 50, "font-size": 10.5 }, what)]);
