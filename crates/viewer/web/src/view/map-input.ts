// Pointer and keys on the map.

import type { MapHandlers, MapView } from "./map";

const ZOOM_STEP = 1.25;
const WIPE_REACH_PX = 8;
/** A pointer that moved less was held still. */
const STILL_PX = 4;

export const listenMap = (map: MapView, handlers: MapHandlers): void => {
  const { canvas } = map;
  let from: { x: number; y: number; moved: boolean } | undefined;
  let wiping = false;
  const onWipe = (x: number): boolean => map.wipeX !== undefined && Math.abs(x - map.wipeX) < WIPE_REACH_PX;

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (onWipe(event.offsetX)) wiping = true;
    else from = { x: event.offsetX, y: event.offsetY, moved: false };
  });
  canvas.addEventListener("pointermove", (event) => {
    const { offsetX: x, offsetY: y } = event;
    if (wiping) {
      handlers.wipe(Math.min(1, Math.max(0, x / canvas.clientWidth)));
    } else if (from) {
      const [dx, dy] = [x - from.x, y - from.y];
      if (!from.moved && Math.hypot(dx, dy) < STILL_PX) return;
      map.pan(dx, dy);
      from = { x, y, moved: true };
    } else {
      const { cell, of } = map.asked(x, y);
      handlers.probe(cell, of);
      canvas.style.cursor = onWipe(x) ? "ew-resize" : map.goalAt(x, y) === undefined ? "crosshair" : "pointer";
    }
  });
  canvas.addEventListener("pointerup", (event) => {
    if (from && !from.moved) handlers.pick(map.goalAt(event.offsetX, event.offsetY), map.sideAt(event.offsetX));
    from = undefined;
    wiping = false;
  });
  canvas.addEventListener("pointercancel", () => {
    from = undefined;
    wiping = false;
  });
  canvas.addEventListener("pointerleave", () => handlers.probe(undefined, "a"));
  canvas.addEventListener("dblclick", () => map.fit());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      map.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => key(map, event));
};

/** On the focused map: + and −, 0, Shift and arrows to pan, Alt and arrows to ask about a cell. */
const key = (map: MapView, event: KeyboardEvent): void => {
  const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const arrow = arrows[event.key];
  if (event.key === "+" || event.key === "=") map.zoom(ZOOM_STEP);
  else if (event.key === "-") map.zoom(1 / ZOOM_STEP);
  else if (event.key === "0") map.fit();
  else if (arrow && event.shiftKey) map.pan(-40 * arrow[0], -40 * arrow[1]);
  else if (arrow && event.altKey) map.step(...arrow);
  else return;
  event.preventDefault();
  event.stopPropagation();
};
