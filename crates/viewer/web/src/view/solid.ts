// The ground in three dimensions, the layer draped over it; of two runs, each on its side of the wipe or in its half.
//
// The drape is the very picture of the flat map, relief and all, so that colours mean the same in both.

import { MathUtils, PerspectiveCamera, Scene, Spherical, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { range } from "../model/plane";
import { Surface } from "./canvas";
import type { Size } from "./canvas";
import type { Beside } from "./map";
import type { Scale } from "./paint";
import { goodStretch, SolidGround } from "./solid-ground";
import type { SolidSide } from "./solid-ground";
import { sizeLabel, thinOut } from "./solid-label";

export interface SolidScene extends SolidSide {
  scale: Scale;
  /** By how much heights are stretched; as much as shows them well, if nothing is said. */
  heights: number | undefined;
  other?: SolidSide & { wipe: Beside };
}

const inHalves = (scene: SolidScene | undefined): boolean => scene?.other !== undefined && typeof scene.other.wipe !== "number";

/** From the south-west and a third of the way up, as the paper's Fig. 10 is seen. */
const AZIMUTH = MathUtils.degToRad(217.5);
const ALTITUDE = MathUtils.degToRad(36);
const DISTANCE = 1.72;
/** The middle of the view, toward the reader from that of the ground: what is near looks larger. */
const NEARER = 0.06;
const FIELD_DEG = 38;
/** Half of what must be in sight across, in widths of the ground. */
const HALF_ACROSS = 0.86;
const STEEPEST = Math.PI * 0.49;
const HALF_FIELD = Math.tan(MathUtils.degToRad(FIELD_DEG / 2));

export class SolidView {
  private readonly surface: Surface;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.001, 20);
  private readonly controls: OrbitControls;
  private readonly a = new SolidGround();
  private readonly b = new SolidGround();
  private shown: SolidScene | undefined;
  private stretch = 1;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.scene.add(this.a.group, this.b.group);
    this.surface = new Surface(canvas, (size) => this.draw(size));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = STEEPEST;
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.controls.addEventListener("change", () => this.redraw());
    this.fit();
  }

  /** The whole ground in sight. */
  fit(): void {
    const { width, height } = this.surface.size;
    const aspect = (inHalves(this.shown) ? width / 2 : width) / (height || 1) || 1;
    const distance = Math.max(DISTANCE, HALF_ACROSS / (HALF_FIELD * aspect));
    const level = Math.cos(ALTITUDE);
    const toward = new Vector3(Math.sin(AZIMUTH), 0, -Math.cos(AZIMUTH));
    this.controls.target.copy(toward).multiplyScalar(NEARER);
    this.camera.position.copy(toward).multiplyScalar(level).setY(Math.sin(ALTITUDE)).multiplyScalar(distance).add(this.controls.target);
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
    this.stretch = scene.heights ?? goodStretch(scene);
    // Both grounds by one measure, so that they can be held against each other; other ground has its own foot.
    const lowest = range(scene.elevation)?.min ?? 0;
    this.a.show(scene, scene.scale, this.stretch, lowest);
    if (scene.other) this.b.show(scene.other, scene.scale, this.stretch, scene.other.wipe === "apart" ? (range(scene.other.elevation)?.min ?? 0) : lowest);
    if (was?.run !== scene.run || inHalves(was) !== inHalves(scene)) this.fit();
    this.redraw();
  }

  redraw(): void {
    this.surface.redraw();
  }

  private draw({ width, height, ratio }: Size): void {
    const { renderer } = this;
    renderer.setPixelRatio(ratio);
    renderer.setSize(width, height, false);
    const other = this.shown?.other;
    for (const sprite of [...this.a.labels, ...this.b.labels]) sizeLabel(sprite, height / (2 * HALF_FIELD));
    const at = other ? (typeof other.wipe === "number" ? other.wipe : 0.5) * width : width;
    if (inHalves(this.shown)) {
      this.part(this.a, 0, at, 0, at, height);
      this.part(this.b, at, width - at, at, width - at, height);
    } else {
      this.part(this.a, 0, width, 0, at, height);
      if (other) this.part(this.b, 0, width, at, width - at, height);
    }
  }

  /** Draws one ground as seen in a part of the canvas, and of that only what lies between two lines. */
  private part(ground: SolidGround, x: number, width: number, from: number, across: number, height: number): void {
    if (across <= 0) return;
    const { renderer, camera } = this;
    this.a.group.visible = ground === this.a;
    this.b.group.visible = ground === this.b;
    renderer.setViewport(x, 0, width, height);
    renderer.setScissor(from, 0, across, height);
    renderer.setScissorTest(true);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    thinOut(ground.labels, camera, width, height);
    renderer.render(this.scene, camera);
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
    const from = new Spherical().setFromVector3(new Vector3().subVectors(this.camera.position, this.controls.target));
    from.theta += aside * 0.15;
    from.phi = Math.min(STEEPEST, Math.max(0.05, from.phi + up * 0.1));
    this.camera.position.setFromSpherical(from).add(this.controls.target);
    this.controls.update();
    this.redraw();
  }
}
