// Names in three dimensions: flat, of one size on the screen, and never behind the ground.

import { CanvasTexture, LinearFilter, SRGBColorSpace, Sprite, SpriteMaterial, Vector3 } from "three";
import type { PerspectiveCamera } from "three";

const HEIGHT_PX = 18;
/** Finer than the screen, so that they stay sharp on any. */
const FINENESS = 2;

export const label = (words: string, picked: boolean): Sprite => {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  const font = `600 ${(picked ? 13.5 : 12) * FINENESS}px system-ui, sans-serif`;
  if (context) context.font = font;
  canvas.width = Math.ceil(context?.measureText(words).width ?? 0) + 8 * FINENESS;
  canvas.height = HEIGHT_PX * FINENESS;
  if (context) {
    // A canvas that was given a size has lost its font.
    context.font = font;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineJoin = "round";
    context.lineWidth = 4 * FINENESS;
    context.strokeStyle = "rgb(255 255 255 / 0.95)";
    context.strokeText(words, canvas.width / 2, canvas.height / 2);
    context.fillStyle = "#111";
    context.fillText(words, canvas.width / 2, canvas.height / 2);
  }
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = LinearFilter;
  texture.generateMipmaps = false;
  const sprite = new Sprite(new SpriteMaterial({ map: texture, transparent: true, depthTest: false, depthWrite: false, sizeAttenuation: false }));
  sprite.center.set(0.5, -0.15);
  sprite.renderOrder = 10;
  sprite.userData = { widthPx: canvas.width / FINENESS, heightPx: HEIGHT_PX };
  return sprite;
};

interface Box {
  x: number;
  y: number;
  widthPx: number;
  heightPx: number;
}

/** Shows those labels that no other one before them would be written over; the first matters most. */
export const thinOut = (labels: readonly Sprite[], camera: PerspectiveCamera, width: number, height: number): void => {
  const shown: Box[] = [];
  for (const sprite of labels) {
    const { x, y } = new Vector3().copy(sprite.position).project(camera);
    const { widthPx, heightPx } = sprite.userData as { widthPx: number; heightPx: number };
    const box = { x: (x / 2) * width, y: (y / 2) * height, widthPx, heightPx };
    sprite.visible = shown.every((other) => Math.abs(other.x - box.x) * 2 > other.widthPx + widthPx || Math.abs(other.y - box.y) * 2 > other.heightPx + heightPx);
    if (sprite.visible) shown.push(box);
  }
};

/** Gives a label its size, where a length of one fills so many pixels. */
export const sizeLabel = (sprite: Sprite, unitPx: number): void => {
  const { widthPx, heightPx } = sprite.userData as { widthPx: number; heightPx: number };
  sprite.scale.set(widthPx / unitPx, heightPx / unitPx, 1);
};
