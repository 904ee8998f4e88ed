// A plane as a picture: colour by value, light by relief.

import type { Plane } from "../model/plane";
import { classStep, colourTable, NO_CLASS } from "./colour";
import type { ColourMapName } from "./colour";
import type { Relief } from "./relief";

export interface Scale {
  colours: ColourMapName;
  min: number;
  max: number;
  /** Values that stand for classes: each has a colour of its own, and nothing lies between. */
  classes?: readonly number[];
  /** From where to where the values go, if some lie beyond the ends and have the colours of the ends. */
  beyond?: { min: number; max: number };
}

/** How much the relief darkens; it lightens about half as much, because light colours lose their hue sooner. */
const SHADE = 0.5;
const LIGHTEN = 0.55;
const COLOURS = 256;
/** Steps of light: more would not be told apart. */
const LIGHTS = 64;
const LEVEL = LIGHTS / 2;

const lit = new Map<ColourMapName, Uint32Array>();

/** Every colour of a map in every light, as pixels: painting is then two look-ups a cell. */
const litColours = (name: ColourMapName): Uint32Array => {
  const known = lit.get(name);
  if (known) return known;
  const colours = colourTable(name);
  const bytes = new Uint8ClampedArray(COLOURS * LIGHTS * 4);
  for (let light = 0; light < LIGHTS; light++) {
    const up = (light - LEVEL) / LEVEL;
    // Towards white above level, towards black below: hues stay what the legend says.
    const shade = up * SHADE * (up > 0 ? LIGHTEN : 1);
    for (let step = 0; step < COLOURS; step++) {
      const to = (light * COLOURS + step) * 4;
      for (let c = 0; c < 3; c++) {
        const colour = colours[step * 3 + c] ?? 0;
        bytes[to + c] = shade > 0 ? colour + (255 - colour) * shade : colour * (1 + shade);
      }
      bytes[to + 3] = 255;
    }
  }
  const made = new Uint32Array(bytes.buffer);
  lit.set(name, made);
  return made;
};

/** One pixel a cell; what is not known is left clear. */
export const paint = (plane: Plane, scale: Scale, relief: Relief | undefined): ImageData => {
  const image = new ImageData(plane.cols, plane.rows);
  const pixels = new Uint32Array(image.data.buffer);
  const colours = litColours(scale.colours);
  const { values, rows, cols } = plane;
  const slope = (COLOURS - 1) / (scale.max - scale.min || 1);
  const classes = scale.classes && new Map(scale.classes.map((value, i) => [value, classStep(i)]));
  for (let row = 0; row < rows; row++) {
    // The relief may cover another part of the ground.
    const lightRow = relief ? row + plane.row - relief.plane.row : -1;
    const shaded = relief && lightRow >= 0 && lightRow < relief.plane.rows ? relief : undefined;
    const from = shaded ? lightRow * shaded.plane.cols + plane.col - shaded.plane.col : 0;
    const [first, last] = shaded ? [shaded.plane.col - plane.col, shaded.plane.col - plane.col + shaded.plane.cols] : [0, 0];
    for (let col = 0; col < cols; col++) {
      const value = values[row * cols + col] as number;
      if (value !== value) continue;
      const step = classes ? (classes.get(value) ?? NO_CLASS) : Math.min(COLOURS - 1, Math.max(0, Math.round((value - scale.min) * slope)));
      const light = shaded && col >= first && col < last ? Math.min(LIGHTS - 1, Math.round((shaded.light[from + col] as number) * LIGHTS)) : LEVEL;
      pixels[row * cols + col] = colours[light * COLOURS + step] as number;
    }
  }
  return image;
};
