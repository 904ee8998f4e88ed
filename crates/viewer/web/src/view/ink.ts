// One way to draw, onto a canvas or into an SVG: so that a figure that is saved is the one that is seen.

import { s } from "../ui/dom";

export interface Paint {
  fill?: string;
  /** Opacity of the fill. */
  alpha?: number;
  stroke?: string;
  width?: number;
  dash?: readonly number[];
}

export interface Lettering {
  size: number;
  fill: string;
  anchor: "start" | "middle" | "end";
  bold?: boolean;
}

/** Pixels, y downwards; text is centred on its y. */
export interface Ink {
  line(x0: number, y0: number, x1: number, y1: number, paint: Paint): void;
  rect(x: number, y: number, width: number, height: number, paint: Paint): void;
  circle(x: number, y: number, radius: number, paint: Paint): void;
  /** An outline around the origin, in SVG's words, put at a place. */
  path(outline: string, x: number, y: number, paint: Paint): void;
  text(words: string, x: number, y: number, lettering: Lettering): void;
  /** Draws within a rectangle only. */
  within(x: number, y: number, width: number, height: number, draw: () => void): void;
}

const FAMILY = "system-ui, sans-serif";

export class CanvasInk implements Ink {
  private readonly outlines = new Map<string, Path2D>();

  constructor(private readonly context: CanvasRenderingContext2D) {}

  line(x0: number, y0: number, x1: number, y1: number, paint: Paint): void {
    const { context } = this;
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    this.put(paint);
  }

  rect(x: number, y: number, width: number, height: number, paint: Paint): void {
    this.context.beginPath();
    this.context.rect(x, y, width, height);
    this.put(paint);
  }

  circle(x: number, y: number, radius: number, paint: Paint): void {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.put(paint);
  }

  path(outline: string, x: number, y: number, paint: Paint): void {
    const path = this.outlines.get(outline) ?? new Path2D(outline);
    this.outlines.set(outline, path);
    this.context.save();
    this.context.translate(x, y);
    this.put(paint, path);
    this.context.restore();
  }

  text(words: string, x: number, y: number, { size, fill, anchor, bold }: Lettering): void {
    const { context } = this;
    context.font = `${bold ? "600 " : ""}${size}px ${FAMILY}`;
    context.textAlign = anchor === "middle" ? "center" : anchor;
    context.textBaseline = "middle";
    context.fillStyle = fill;
    context.fillText(words, x, y);
  }

  within(x: number, y: number, width: number, height: number, draw: () => void): void {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(x, y, width, height);
    context.clip();
    draw();
    context.restore();
  }

  private put({ fill, alpha, stroke, width, dash }: Paint, path?: Path2D): void {
    const { context } = this;
    if (fill) {
      context.fillStyle = fill;
      context.globalAlpha = alpha ?? 1;
      if (path) context.fill(path);
      else context.fill();
      context.globalAlpha = 1;
    }
    if (!stroke) return;
    context.strokeStyle = stroke;
    context.lineWidth = width ?? 1;
    context.setLineDash(dash ? [...dash] : []);
    if (path) context.stroke(path);
    else context.stroke();
    context.setLineDash([]);
  }
}

/** Draws into an SVG that stands without this page: colours and letters are inside. */
export class SvgInk implements Ink {
  readonly svg: SVGSVGElement;
  private into: SVGElement;
  private clips = 0;

  constructor(width: number, height: number, background: string, label: string) {
    this.svg = s("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": label, "font-family": FAMILY });
    this.svg.append(s("title", {}, label), s("rect", { width, height, fill: background }));
    this.into = this.svg;
  }

  line(x0: number, y0: number, x1: number, y1: number, paint: Paint): void {
    this.into.append(s("line", { x1: n(x0), y1: n(y0), x2: n(x1), y2: n(y1), ...look(paint) }));
  }

  rect(x: number, y: number, width: number, height: number, paint: Paint): void {
    this.into.append(s("rect", { x: n(x), y: n(y), width: n(width), height: n(height), ...look(paint) }));
  }

  circle(x: number, y: number, radius: number, paint: Paint): void {
    this.into.append(s("circle", { cx: n(x), cy: n(y), r: n(radius), ...look(paint) }));
  }

  path(outline: string, x: number, y: number, paint: Paint): void {
    this.into.append(s("path", { d: outline, transform: `translate(${n(x)} ${n(y)})`, ...look(paint) }));
  }

  text(words: string, x: number, y: number, { size, fill, anchor, bold }: Lettering): void {
    // Not every program that draws SVG knows a baseline in the middle.
    this.into.append(s("text", { x: n(x), y: n(y + size * 0.35), "font-size": size, fill, "text-anchor": anchor, "font-weight": bold ? 600 : undefined }, words));
  }

  within(x: number, y: number, width: number, height: number, draw: () => void): void {
    const id = `within-${this.clips++}`;
    const group = s("g", { "clip-path": `url(#${id})` });
    this.svg.append(s("clipPath", { id }, s("rect", { x: n(x), y: n(y), width: n(width), height: n(height) })));
    const before = this.into;
    before.append(group);
    this.into = group;
    draw();
    this.into = before;
  }
}

/** Hundredths of a pixel are enough. */
const n = (value: number): number => Math.round(value * 100) / 100;

const look = ({ fill, alpha, stroke, width, dash }: Paint): Record<string, string | number | undefined> => ({
  fill: fill ?? "none",
  "fill-opacity": alpha,
  stroke,
  "stroke-width": stroke ? (width ?? 1) : undefined,
  "stroke-dasharray": dash?.join(" "),
});
