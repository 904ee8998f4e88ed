// Shapes on a canvas.

import { filled, MARK_PX, markPath2d, markRadius, markText, stateColour } from "./marks";
import { ROVER_PATH } from "./shapes";
import type { Dot, Mark, Rover, Shape, Way } from "./shapes";
import type { Point } from "./viewport";
import type { Cell } from "../model/types";

/** How far a mark and its name reach. */
const MARGIN_PX = 40;

type Place = (cell: Cell) => Point;

/** What lies within a part of the canvas, from its left to its right. */
export const drawShapes = (context: CanvasRenderingContext2D, all: readonly Shape[], place: Place, from: number, to: number, height: number): void => {
  const seen = (cell: Cell): boolean => {
    const { x, y } = place(cell);
    return x > from - MARGIN_PX && x < to + MARGIN_PX && y > -MARGIN_PX && y < height + MARGIN_PX;
  };
  for (const shape of all) {
    if (shape.kind !== "way" && !seen(shape.cell)) continue;
    if (shape.kind === "way") drawWay(context, shape, place);
    else if (shape.kind === "mark") drawMark(context, shape, place);
    else if (shape.kind === "rover") drawRover(context, shape, place);
    else drawDot(context, shape, place);
  }
};

const drawWay = (context: CanvasRenderingContext2D, { lines, colour, width, dash, opacity, casing }: Way, place: Place): void => {
  const path = new Path2D();
  for (const cells of lines) {
    cells.forEach((cell, i) => {
      const { x, y } = place(cell);
      if (i === 0) path.moveTo(x, y);
      else path.lineTo(x, y);
    });
  }
  context.save();
  context.lineJoin = "round";
  context.lineCap = dash.length > 0 ? "butt" : "round";
  context.strokeStyle = `rgb(255 255 255 / ${casing})`;
  context.lineWidth = width + 2.2;
  context.stroke(path);
  context.globalAlpha = opacity;
  context.setLineDash([...dash]);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke(path);
  context.restore();
};

const drawDot = (context: CanvasRenderingContext2D, { cell, colour }: Dot, place: Place): void => {
  const { x, y } = place(cell);
  context.beginPath();
  context.arc(x, y, 3.2, 0, 2 * Math.PI);
  context.fillStyle = colour;
  context.strokeStyle = "#fff";
  context.lineWidth = 1.2;
  context.fill();
  context.stroke();
};

const drawMark = (context: CanvasRenderingContext2D, mark: Mark, place: Place): void => {
  const { goal, cell, state, picked } = mark;
  const { x, y } = place(cell);
  const path = markPath2d(state, markRadius(state));
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
  const words = markText(mark);
  if (words) {
    context.font = `600 ${words.text.length > 1 ? 9.5 : 10.5}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = words.colour;
    context.fillText(words.text, 0, 0.5);
  }
  context.restore();
  if (picked) drawLabel(context, `G${goal}`, x, y - MARK_PX - 15);
};

const drawRover = (context: CanvasRenderingContext2D, { cell, headingRad }: Rover, place: Place): void => {
  const { x, y } = place(cell);
  context.save();
  context.translate(x, y);
  // Headings turn clockwise from north, as the canvas does from its top.
  context.rotate(headingRad);
  const arrow = new Path2D(ROVER_PATH);
  context.lineJoin = "round";
  context.lineWidth = 4.5;
  context.strokeStyle = "#fff";
  context.stroke(arrow);
  context.fillStyle = "#111";
  context.fill(arrow);
  context.restore();
};

/** Words that can be read on any ground. */
export const drawLabel = (context: CanvasRenderingContext2D, words: string, x: number, y: number): void => {
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = "rgb(255 255 255 / 0.95)";
  context.strokeText(words, x, y);
  context.fillStyle = "#111";
  context.fillText(words, x, y);
};
