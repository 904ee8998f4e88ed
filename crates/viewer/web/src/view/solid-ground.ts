// The ground of one run in three dimensions: a mesh with the flat map's picture on it, and marks.

import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  ConeGeometry,
  DoubleSide,
  Group,
  LinearMipmapLinearFilter,
  Mesh,
  MeshBasicMaterial,
  NearestFilter,
  SRGBColorSpace,
  SphereGeometry,
  Sprite,
  Vector3,
} from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";

import { range } from "../model/plane";
import type { Plane } from "../model/plane";
import type { Cell } from "../model/types";
import { stateColour } from "./marks";
import type { MapSide } from "./map";
import { paint } from "./paint";
import type { Scale } from "./paint";
import { shapes } from "./shapes";
import type { Mark, Rover, Way } from "./shapes";
import { label } from "./solid-label";

export interface SolidSide extends MapSide {
  elevation: Plane;
}

/** Corners of the mesh on a side; more would not be seen. */
const MOST_CORNERS = 512;
/** How high the ground stands, against its width, once heights are stretched; true heights if they are higher. */
const GOOD_HEIGHT = 0.08;

/** By how much heights are best stretched, to show the shape of the ground. */
export const goodStretch = ({ elevation, run }: SolidSide): number => {
  const { grid } = run.facts;
  const heights = range(elevation) ?? { min: 0, max: 0 };
  const high = (heights.max - heights.min) / (Math.max(grid.rows, grid.cols) * grid.spacingM);
  return high > 0 ? Math.max(1, GOOD_HEIGHT / high) : 1;
};

export class SolidGround {
  readonly group = new Group();
  private readonly picture = document.createElement("canvas");
  private readonly texture = new CanvasTexture(this.picture);
  private readonly ground = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ map: this.texture, side: DoubleSide }));
  private marks = new Group();
  private side: SolidSide | undefined;
  private drapedBy = "";
  private stretch = 1;
  private lowest = 0;

  constructor() {
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.magFilter = NearestFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    this.texture.anisotropy = 8;
    this.group.add(this.ground, this.marks);
  }

  /** What matters most comes first: marks are drawn from the least of them to the one on top. */
  get labels(): Sprite[] {
    return this.marks.children.filter((child) => child instanceof Sprite).reverse();
  }

  show(side: SolidSide, scale: Scale, stretch: number, lowest: number): void {
    const was = this.side;
    const moved = was?.elevation !== side.elevation || this.stretch !== stretch || this.lowest !== lowest;
    const drapedBy = JSON.stringify(scale);
    this.side = side;
    [this.stretch, this.lowest] = [stretch, lowest];
    if (moved) this.shape(side);
    if (was?.plane !== side.plane || was?.relief !== side.relief || this.drapedBy !== drapedBy) this.drape(side, scale);
    this.drapedBy = drapedBy;
    const marked = moved || was.run !== side.run || was.index !== side.index || was.goal !== side.goal || was.option !== side.option;
    if (marked || was.alternatives !== side.alternatives || was.family !== side.family) this.place(side);
  }

  /** The mesh: a corner in the middle of every cell, or of every so many. */
  private shape({ elevation }: SolidSide): void {
    const step = Math.max(1, Math.ceil(Math.max(elevation.rows, elevation.cols) / MOST_CORNERS));
    const [rows, cols] = [Math.ceil(elevation.rows / step), Math.ceil(elevation.cols / step)];
    const positions = new Float32Array(rows * cols * 3);
    const uvs = new Float32Array(rows * cols * 2);
    for (let r = 0; r < rows; r++) {
      for (let c = 0; c < cols; c++) {
        const cell = { row: Math.min(r * step, elevation.rows - 1) + elevation.row, col: Math.min(c * step, elevation.cols - 1) + elevation.col };
        const { x, y, z } = this.at(cell, 0);
        positions.set([x, y, z], (r * cols + c) * 3);
        uvs.set([(cell.col - elevation.col + 0.5) / elevation.cols, 1 - (cell.row - elevation.row + 0.5) / elevation.rows], (r * cols + c) * 2);
      }
    }
    const faces = new Uint32Array((rows - 1) * (cols - 1) * 6);
    for (let r = 0, next = 0; r < rows - 1; r++) {
      for (let c = 0; c < cols - 1; c++, next += 6) {
        const corner = r * cols + c;
        faces.set([corner, corner + cols, corner + 1, corner + 1, corner + cols, corner + cols + 1], next);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("uv", new BufferAttribute(uvs, 2));
    geometry.setIndex(new BufferAttribute(faces, 1));
    this.ground.geometry.dispose();
    this.ground.geometry = geometry;
  }

  private drape({ plane, elevation, relief }: SolidSide, scale: Scale): void {
    this.picture.width = elevation.cols;
    this.picture.height = elevation.rows;
    const context = this.picture.getContext("2d");
    if (!context) return;
    context.fillStyle = "#8b8f94";
    context.fillRect(0, 0, elevation.cols, elevation.rows);
    if (plane) {
      // A layer may cover another part of the ground than the elevation does, and what it does not know is clear.
      const painted = document.createElement("canvas");
      [painted.width, painted.height] = [plane.cols, plane.rows];
      painted.getContext("2d")?.putImageData(paint(plane, scale, relief), 0, 0);
      context.drawImage(painted, plane.col - elevation.col, plane.row - elevation.row);
    }
    // A texture keeps the size that it first had.
    this.texture.dispose();
    this.texture.needsUpdate = true;
  }

  /** Where a cell lies in the scene, so many cells above the ground. North is away from the reader, the width is one. */
  private at(cell: Cell, aboveCells: number): Vector3 {
    const { side } = this;
    if (!side) return new Vector3();
    const { grid } = side.run.facts;
    const { elevation } = side;
    const size = Math.max(grid.rows, grid.cols);
    const row = Math.min(elevation.rows - 1, Math.max(0, cell.row - elevation.row));
    const col = Math.min(elevation.cols - 1, Math.max(0, cell.col - elevation.col));
    const height = elevation.values[row * elevation.cols + col] ?? this.lowest;
    const known = Number.isNaN(height) ? this.lowest : height;
    return new Vector3(
      (cell.col + 0.5 - grid.cols / 2) / size,
      (((known - this.lowest) / grid.spacingM) * this.stretch) / size + aboveCells / size,
      (cell.row + 0.5 - grid.rows / 2) / size,
    );
  }

  private place(side: SolidSide): void {
    for (const old of this.marks.children) {
      if (old instanceof Mesh) {
        old.geometry.dispose();
        (old.material as MeshBasicMaterial).dispose();
      } else if (old instanceof Sprite) {
        old.material.map?.dispose();
        old.material.dispose();
      }
    }
    this.group.remove(this.marks);
    this.marks = new Group();
    this.group.add(this.marks);
    const { grid } = side.run.facts;
    // Of a size to be seen, whatever the size of the ground.
    const lift = Math.max(grid.rows, grid.cols) * 0.006;
    for (const shape of shapes(side)) {
      if (shape.kind === "way") this.way(shape, lift);
      else if (shape.kind === "mark") this.mark(shape, lift);
      else if (shape.kind === "rover") this.rover(shape, lift);
    }
  }

  private mark({ cell, goal, state, turn, picked }: Mark, lift: number): void {
    if (state === "dropped") return;
    const radius = picked ? 0.014 : state === "deferred" ? 0.005 : 0.009;
    const ball = new Mesh(new SphereGeometry(radius, 20, 14), new MeshBasicMaterial({ color: stateColour[state] }));
    ball.position.copy(this.at(cell, lift)).add(new Vector3(0, radius, 0));
    this.marks.add(ball);
    // A name on each of many deferred goals would hide the ground.
    if (state === "deferred" && !picked) return;
    const name = label(turn === undefined ? `G${goal}` : `${turn + 1}. G${goal}`, picked);
    name.position.copy(ball.position).add(new Vector3(0, radius, 0));
    this.marks.add(name);
  }

  private rover({ cell, headingRad }: Rover, lift: number): void {
    const rover = new Mesh(new ConeGeometry(0.011, 0.034, 4), new MeshBasicMaterial({ color: "#111111" }));
    rover.position.copy(this.at(cell, lift)).add(new Vector3(0, 0.012, 0));
    // Lying down, its tip to where the rover faces: clockwise from north, which is away from the reader.
    rover.rotation.set(-Math.PI / 2, -headingRad, 0, "YXZ");
    this.marks.add(rover);
  }

  private way({ lines, colour, width, opacity }: Way, lift: number): void {
    // One object for all lines: a long run has thousands.
    const ends = lines.flatMap((cells) => cells.slice(1).map((cell, i): [Cell, Cell] => [cells[i] ?? cell, cell]));
    if (ends.length === 0) return;
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(ends.flatMap(([from, to]) => [...this.at(from, lift).toArray(), ...this.at(to, lift).toArray()]));
    this.marks.add(new LineSegments2(geometry, new LineMaterial({ color: colour, linewidth: width * 1.4, transparent: opacity < 1, opacity })));
  }
}
