// Light and shade from the elevation.

import { range } from "../model/plane";
import type { Plane } from "../model/plane";

/** How a hillshade was made. */
export interface Relief {
  /** Light on each cell in [0, 1]; 0.5 where the ground is level or not known. */
  light: Float32Array;
  plane: Plane;
  /** By how much heights were stretched, so that flat ground shows its shape too. */
  stretch: number;
}

/** Light from the north-west, 45 degrees high: the reader's eye expects it from above left. */
const AZIMUTH = (315 * Math.PI) / 180;
const ALTITUDE = Math.PI / 4;
/** Slope, rise over run, that the steeper parts of a scene are stretched to. */
const GOOD_SLOPE = 0.45;
const STRETCHES = [0.25, 0.5, 1, 2, 3, 5, 8, 12] as const;

/** Horn's slopes (1981) at a cell, eastward and southward; the centre stands in for neighbours that are not known. */
const slopes = (plane: Plane, row: number, col: number, spacingM: number): [number, number] => {
  const centre = plane.values[row * plane.cols + col] ?? Number.NaN;
  const z = (dr: number, dc: number): number => {
    const [r, c] = [row + dr, col + dc];
    if (r < 0 || c < 0 || r >= plane.rows || c >= plane.cols) return centre;
    const value = plane.values[r * plane.cols + c] ?? Number.NaN;
    return Number.isNaN(value) ? centre : value;
  };
  const east = z(-1, 1) + 2 * z(0, 1) + z(1, 1);
  const west = z(-1, -1) + 2 * z(0, -1) + z(1, -1);
  const south = z(1, -1) + 2 * z(1, 0) + z(1, 1);
  const north = z(-1, -1) + 2 * z(-1, 0) + z(-1, 1);
  return [(east - west) / (8 * spacingM), (south - north) / (8 * spacingM)];
};

/** The light on a cell of given slopes. */
export const lightOn = (east: number, south: number): number => {
  // The surface's normal is (−east, south, 1) with y to the north; the sun stands at azimuth and altitude.
  const sun = [Math.sin(AZIMUTH) * Math.cos(ALTITUDE), Math.cos(AZIMUTH) * Math.cos(ALTITUDE), Math.sin(ALTITUDE)] as const;
  const length = Math.hypot(east, south, 1);
  return Math.max(0, (-east * sun[0] + south * sun[1] + sun[2]) / length);
};

/** The hillshade of an elevation plane; nothing if it is level or unknown throughout. */
export const relief = (plane: Plane, spacingM: number): Relief | undefined => {
  const heights = range(plane);
  if (!heights || heights.max - heights.min <= 0) return undefined;
  const cells = plane.rows * plane.cols;
  const east = new Float32Array(cells);
  const south = new Float32Array(cells);
  const steep: number[] = [];
  for (let row = 0; row < plane.rows; row++) {
    for (let col = 0; col < plane.cols; col++) {
      const [e, s] = slopes(plane, row, col, spacingM);
      const place = row * plane.cols + col;
      east[place] = Number.isNaN(e) ? 0 : e;
      south[place] = Number.isNaN(s) ? 0 : s;
      if (place % 7 === 0) steep.push(Math.hypot(east[place] ?? 0, south[place] ?? 0));
    }
  }
  steep.sort((a, b) => a - b);
  const typical = steep[Math.floor(steep.length * 0.85)] ?? 0;
  const wanted = typical > 0 ? GOOD_SLOPE / typical : 1;
  const stretch = STRETCHES.findLast((step) => step <= wanted) ?? STRETCHES[0];
  const level = lightOn(0, 0);
  const light = new Float32Array(cells);
  for (let place = 0; place < cells; place++) {
    const lit = lightOn((east[place] ?? 0) * stretch, (south[place] ?? 0) * stretch);
    // Level ground is 0.5, so that a shaded map is neither darker nor lighter than its legend.
    light[place] = lit <= level ? (0.5 * lit) / level : 0.5 + (0.5 * (lit - level)) / (1 - level);
  }
  return { light, plane, stretch };
};
