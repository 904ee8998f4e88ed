// Goals of two runs that are of one place: each run gives its goals names of its own.

import type { Cell, GridSpec } from "./types";

interface Placed {
  directive: string;
  target: Cell;
}

/** A goal of the first run and the one of the second that is of the same place; a side is absent where there is none. */
export interface Pair<T> {
  a?: T;
  b?: T;
}

const awayM = (a: Placed, b: Placed, grid: GridSpec): number =>
  Math.hypot(a.target.row - b.target.row, a.target.col - b.target.col) * grid.spacingM;

/** Of one directive, and no farther apart than goals of one place may be. */
export const samePlace = (a: Placed, b: Placed, grid: GridSpec, radiusM: number): boolean =>
  a.directive === b.directive && awayM(a, b, grid) <= radiusM;

/**
 * Each goal with the nearest of its place that is not taken by a nearer one: pairs first, in the order of the first
 * run, then what only the second has.
 */
export const paired = <T extends Placed>(left: readonly T[], right: readonly T[], grid: GridSpec, radiusM: number): Pair<T>[] => {
  // Squares as wide as the radius: what is near lies in one of nine.
  const side = Math.max(1, radiusM / grid.spacingM);
  const square = ({ target }: Placed, down = 0, across = 0): string => `${Math.floor(target.row / side) + down}/${Math.floor(target.col / side) + across}`;
  const squares = new Map<string, number[]>();
  right.forEach((goal, j) => {
    const key = square(goal);
    const there = squares.get(key) ?? [];
    squares.set(key, there);
    there.push(j);
  });
  const near = left.flatMap((goal, i) =>
    [-1, 0, 1].flatMap((down) => [-1, 0, 1].flatMap((across) => squares.get(square(goal, down, across)) ?? [])).flatMap((j) => {
      const other = right[j];
      return other && samePlace(goal, other, grid, radiusM) ? [{ i, j, away: awayM(goal, other, grid) }] : [];
    }),
  );
  const [ofLeft, ofRight] = [new Map<number, number>(), new Map<number, number>()];
  for (const { i, j } of near.sort((a, b) => a.away - b.away || a.i - b.i || a.j - b.j)) {
    if (ofLeft.has(i) || ofRight.has(j)) continue;
    ofLeft.set(i, j);
    ofRight.set(j, i);
  }
  return [
    ...left.map((a, i): Pair<T> => {
      const b = right[ofLeft.get(i) ?? -1];
      return b ? { a, b } : { a };
    }),
    ...right.flatMap((b, j): Pair<T>[] => (ofRight.has(j) ? [] : [{ b }])),
  ];
};
