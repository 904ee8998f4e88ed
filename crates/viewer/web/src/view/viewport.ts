// Where the cells of the grid lie on the map.

import type { Cell, GridSpec } from "../model/types";

const LEAST_SCALE = 0.4;
const MOST_SCALE = 80;
const MARGIN_PX = 14;

/** A grid that would be smaller yet is better shown large, even if it is covered in part. */
const LEAST_SHARE = 0.5;

/** Room to be kept clear, pixels. */
export interface Keep {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

const NOTHING: Keep = { left: 0, right: 0, top: 0, bottom: 0 };

export interface Point {
  x: number;
  y: number;
}

export class Viewport {
  /** Pixels a cell, and where the grid's north-west corner lies. */
  scale = 1;
  x = 0;
  y = 0;
  fitted = true;

  /** The whole grid in sight, clear of what lies on the map unless that makes the grid less than half as large. */
  fit(grid: GridSpec, width: number, height: number, keep: Keep): void {
    const fits = ({ left, right, top, bottom }: Keep): number => Math.min((width - left - right - 2 * MARGIN_PX) / grid.cols, (height - top - bottom - 2 * MARGIN_PX) / grid.rows);
    const kept = fits(keep) >= fits(NOTHING) * LEAST_SHARE ? keep : NOTHING;
    const { left, right, top, bottom } = kept;
    this.scale = Math.max(LEAST_SCALE, fits(kept));
    this.x = left + (width - left - right - grid.cols * this.scale) / 2;
    this.y = top + (height - top - bottom - grid.rows * this.scale) / 2;
    this.fitted = true;
  }

  /** Nearer by a factor, about a point that stays. */
  zoom(factor: number, px: number, py: number): void {
    const scale = Math.min(MOST_SCALE, Math.max(LEAST_SCALE, this.scale * factor));
    this.x = px - ((px - this.x) * scale) / this.scale;
    this.y = py - ((py - this.y) * scale) / this.scale;
    this.scale = scale;
    this.fitted = false;
  }

  pan(dx: number, dy: number): void {
    this.x += dx;
    this.y += dy;
    this.fitted = false;
  }

  /** Where a cell's middle lies. */
  place({ row, col }: Cell): Point {
    return { x: this.x + (col + 0.5) * this.scale, y: this.y + (row + 0.5) * this.scale };
  }

  /** The cell under a point, if there is one. */
  cellAt(px: number, py: number, grid: GridSpec): Cell | undefined {
    const cell = { row: Math.floor((py - this.y) / this.scale), col: Math.floor((px - this.x) / this.scale) };
    return cell.row >= 0 && cell.col >= 0 && cell.row < grid.rows && cell.col < grid.cols ? cell : undefined;
  }
}
