// Colour maps whose steps look alike to the eye, colour-blind eyes included; and the colours of goals.
//
// Each map is a few colours of the published one, joined by straight lines in OKLab (Ottosson 2020), where equal
// distances look equal.

export type Rgb = readonly [number, number, number];

/** Anchors, evenly spaced, low to high. */
const ANCHORS = {
  viridis: ["440154", "481a6c", "472f7d", "414487", "39568c", "31688e", "2a788e", "23888e", "1f988b", "22a884", "35b779", "54c568", "7ad151", "a5db36", "d2e21b", "fde725"],
  cividis: ["00204d", "00336f", "39486b", "575c6d", "707173", "8a8779", "a69d75", "c4b56c", "e4cf5b", "ffea46"],
  batlow: ["011959", "103f60", "1c5a62", "3c6d56", "687b3e", "9d892b", "d29343", "f8a17b", "fdb7bc", "faccfa"],
  stone: ["2c2b33", "57545a", "837c78", "b0a594", "d8cdb4", "f4efe2"],
  /** For differences: blue is less, red is more. */
  diverging: ["0b4f8a", "4b8fc4", "a8cbe3", "f4f3f1", "eab59b", "cf6a4b", "8f2317"],
} as const;

/** Classes, in turn: Okabe and Ito's colours, light ones first, so that marks stand out from them. */
const CLASSES = ["56b4e9", "e69f00", "009e73", "f0e442", "cc79a7", "0072b2", "d55e00", "f4efe2"] as const;
/** Of a value that is none of the classes. */
const NO_CLASS_COLOUR = "6d7279";

export type ColourMapName = keyof typeof ANCHORS | "classes";

const toLinear = (c: number): number => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const toGamma = (c: number): number => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);

const hex = (code: string): Rgb => [0, 2, 4].map((i) => Number.parseInt(code.slice(i, i + 2), 16) / 255) as unknown as Rgb;

const toLab = (colour: Rgb): Rgb => {
  const [r, g, b] = colour.map(toLinear) as unknown as Rgb;
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
};

const toRgb = ([lightness, a, b]: Rgb): Rgb => {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((c) => Math.min(1, Math.max(0, toGamma(c)))) as unknown as Rgb;
};

const STEPS = 256;

/** 256 colours, three bytes each. */
const table = (anchors: readonly string[]): Uint8ClampedArray => {
  const labs = anchors.map((code) => toLab(hex(code)));
  const colours = new Uint8ClampedArray(STEPS * 3);
  for (let step = 0; step < STEPS; step++) {
    const place = (step / (STEPS - 1)) * (labs.length - 1);
    const low = Math.min(Math.floor(place), labs.length - 2);
    const [from, to] = [labs[low], labs[low + 1]];
    if (!from || !to) continue;
    const part = place - low;
    const mixed = from.map((v, i) => v + ((to[i] ?? v) - v) * part) as unknown as Rgb;
    toRgb(mixed).forEach((c, i) => {
      colours[step * 3 + i] = Math.round(c * 255);
    });
  }
  return colours;
};

/** The place in the table of the colour of a class; after the last colour they begin anew. */
export const classStep = (i: number): number => i % CLASSES.length;
/** The place of the colour of what is no class. */
export const NO_CLASS = STEPS - 1;

const classTable = (): Uint8ClampedArray => {
  const colours = new Uint8ClampedArray(STEPS * 3);
  for (let step = 0; step < STEPS; step++) {
    hex(CLASSES[step] ?? NO_CLASS_COLOUR).forEach((c, i) => {
      colours[step * 3 + i] = Math.round(c * 255);
    });
  }
  return colours;
};

const tables = new Map<ColourMapName, Uint8ClampedArray>();

/** The 256 colours of a map, red, green and blue in turn. */
export const colourTable = (name: ColourMapName): Uint8ClampedArray => {
  const known = tables.get(name);
  if (known) return known;
  const made = name === "classes" ? classTable() : table(ANCHORS[name]);
  tables.set(name, made);
  return made;
};

/** The colour at a place of the table. */
export const cssAt = (colours: Uint8ClampedArray, step: number): string => `rgb(${colours[3 * step]} ${colours[3 * step + 1]} ${colours[3 * step + 2]})`;

export const css = (colours: Uint8ClampedArray, part: number): string => cssAt(colours, Math.round(Math.min(1, Math.max(0, part)) * (STEPS - 1)));

/** Okabe & Ito (2008): apart from each other for all eyes. */
export const OKABE = {
  orange: "#e69f00",
  sky: "#56b4e9",
  green: "#009e73",
  blue: "#0072b2",
  vermilion: "#d55e00",
  pink: "#cc79a7",
  grey: "#8b8f94",
} as const;
