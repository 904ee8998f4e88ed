// The ground in three dimensions, the layer draped over it.
//
// The drape is the very picture of the flat map, relief and all, so that colours mean the same in both.

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
  PerspectiveCamera,
  SRGBColorSpace,
  Scene,
  SphereGeometry,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

import { range } from "../model/plane";
import type { Plane } from "../model/plane";
import { stateOf } from "../model/states";
import type { Cell } from "../model/types";
import { Surface } from "./canvas";
import type { Size } from "./canvas";
import { OKABE } from "./colour";
import type { MapScene } from "./map";
import { stateColour } from "./marks";
import { paint } from "./paint";

export interface SolidScene extends MapScene {
  elevation: Plane;
}

/** Corners of the mesh on a side; more would not be seen. */
const MOST_CORNERS = 512;
/** How high the ground stands, against its width, once heights are stretched; true heights if they are higher. */
const GOOD_HEIGHT = 0.08;

export class SolidView {
  private readonly surface: Surface;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(38, 1, 0.001, 20);
  private readonly controls: OrbitControls;
  private readonly picture = document.createElement("canvas");
  private readonly texture = new CanvasTexture(this.picture);
  private readonly ground = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ map: this.texture, side: DoubleSide }));
  private marks = new Group();
  private shown: SolidScene | undefined;
  private stretch = 1;
  private lowest = 0;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.magFilter = NearestFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    this.texture.anisotropy = 8;
    this.scene.add(this.ground, this.marks);
    this.surface = new Surface(canvas, (size) => this.draw(size));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = Math.PI * 0.49;
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.controls.addEventListener("change", () => this.redraw());
    this.fit();
  }

  /** From the south, looking down on the whole. */
  fit(): void {
    this.camera.position.set(0, 0.86, 1.22);
    this.controls.target.set(0, 0, 0.02);
    this.controls.update();
    this.redraw();
  }

  /** Nearer by a factor. */
  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).divideScalar(factor).add(this.controls.target);
    this.controls.update();
    this.redraw();
  }

  /** By how much heights are stretched. */
  get heightStretch(): number {
    return this.stretch;
  }

  show(scene: SolidScene): void {
    const was = this.shown;
    this.shown = scene;
    if (was?.elevation !== scene.elevation) this.shape(scene);
    if (was?.plane !== scene.plane || was?.relief !== scene.relief || was?.scale !== scene.scale) this.drape(scene);
    if (was?.index !== scene.index || was.goal !== scene.goal || was.elevation !== scene.elevation || was.run !== scene.run) this.place(scene);
    this.redraw();
  }

  redraw(): void {
    this.surface.redraw();
  }

  private draw({ width, height, ratio }: Size): void {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
  }

  /** On the focused view: + − 0, and Shift and arrows to turn; arrows alone are the page's. */
  private key(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const turn = event.shiftKey ? turns[event.key] : undefined;
    if (event.key === "+" || event.key === "=") this.zoom(1.2);
    else if (event.key === "-") this.zoom(1 / 1.2);
    else if (event.key === "0") this.fit();
    else if (turn) this.turn(turn);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private turn([aside, up]: [number, number]): void {
    const from = new Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    from.theta += aside * 0.15;
    from.phi = Math.min(Math.PI * 0.49, Math.max(0.05, from.phi + up * 0.1));
    this.camera.position.setFromSpherical(from).add(this.controls.target);
    this.controls.update();
    this.redraw();
  }

  /** The mesh: a corner in the middle of every cell, or of every so many. */
  private shape({ elevation, run }: SolidScene): void {
    const { grid } = run.facts;
    const heights = range(elevation) ?? { min: 0, max: 0 };
    this.lowest = heights.min;
    const wide = Math.max(grid.rows, grid.cols) * grid.spacingM;
    const high = (heights.max - heights.min) / wide;
    this.stretch = high > 0 ? Math.max(1, GOOD_HEIGHT / high) : 1;
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

  private drape({ plane, elevation, scale, relief }: SolidScene): void {
    this.picture.width = elevation.cols;
    this.picture.height = elevation.rows;
    const context = this.picture.getContext("2d");
    if (!context) return;
    context.fillStyle = "#8b8f94";
    context.fillRect(0, 0, elevation.cols, elevation.rows);
    // A layer may cover another part of the ground than the elevation does.
    if (plane) context.putImageData(paint(plane, scale, relief), plane.col - elevation.col, plane.row - elevation.row);
    // A texture keeps the size that it first had.
    this.texture.dispose();
    this.texture.needsUpdate = true;
  }

  /** Where a cell lies in the scene, so many cells above the ground. North is away from the reader, the width is one. */
  private at(cell: Cell, aboveCells: number): Vector3 {
    const scene = this.shown;
    if (!scene) return new Vector3();
    const { grid } = scene.run.facts;
    const { elevation } = scene;
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

  private place(scene: SolidScene): void {
    for (const old of this.marks.children) {
      if (old instanceof Mesh) {
        old.geometry.dispose();
        (old.material as MeshBasicMaterial).dispose();
      }
    }
    this.scene.remove(this.marks);
    this.marks = new Group();
    this.scene.add(this.marks);
    const moment = scene.run.moment(scene.index);
    if (!moment) return;
    const { grid } = scene.run.facts;
    // Of a size to be seen, whatever the size of the ground.
    const lift = Math.max(grid.rows, grid.cols) * 0.006;
    for (const track of scene.run.tracks(scene.index)) this.line(track, OKABE.blue, 3, lift);
    const legs = moment.act.name === "pursue" ? moment.legs.map((leg) => leg.cells) : [moment.act.route];
    legs.forEach((cells, turn) => this.line(cells, turn === 0 ? OKABE.vermilion : OKABE.orange, turn === 0 ? 4 : 2.5, lift));
    for (const { verdict, index } of scene.run.verdictsUpTo(scene.index).values()) {
      const state = stateOf(verdict, scene.run.moment(index) ?? moment);
      if (state === "dropped") continue;
      const picked = verdict.goal.id === scene.goal;
      const radius = picked ? 0.014 : state === "deferred" ? 0.005 : 0.009;
      const ball = new Mesh(new SphereGeometry(radius, 20, 14), new MeshBasicMaterial({ color: stateColour[state] }));
      ball.position.copy(this.at(verdict.goal.target, lift)).add(new Vector3(0, radius, 0));
      this.marks.add(ball);
    }
    const rover = new Mesh(new ConeGeometry(0.011, 0.034, 4), new MeshBasicMaterial({ color: "#111111" }));
    rover.position.copy(this.at(moment.pose, lift)).add(new Vector3(0, 0.012, 0));
    // Lying down, its tip to where the rover faces: clockwise from north, which is away from the reader.
    rover.rotation.set(-Math.PI / 2, -moment.headingRad, 0, "YXZ");
    this.marks.add(rover);
  }

  private line(cells: readonly Cell[], colour: string, width: number, lift: number): void {
    if (cells.length < 2) return;
    const geometry = new LineGeometry();
    geometry.setPositions(cells.flatMap((cell) => this.at(cell, lift).toArray()));
    this.marks.add(new Line2(geometry, new LineMaterial({ color: colour, linewidth: width })));
  }
}
