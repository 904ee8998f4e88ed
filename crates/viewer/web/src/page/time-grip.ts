// The upper edge of the timeline: dragged, or moved by the arrow keys, it gives the lanes more room or less.

import { h } from "../ui/dom";

const LEAST_PX = 110;
/** What is left to map and decision. */
const LEFT_ABOVE_PX = 260;
const STEP_PX = 34;

/** `pane` is the timeline; its height is kept where the page is laid out. Twice clicked, or by Escape, it is as it was at first. */
export const timeGrip = (pane: () => HTMLElement): HTMLElement => {
  const grip = h("div", { class: "time-grip", role: "separator", "aria-orientation": "horizontal", "aria-label": "Height of the timeline. Keys: up and down; Escape as at first", title: "Drag for more lanes or fewer; twice clicked it is as at first", tabindex: 0 });
  const whole = (): HTMLElement | null => pane().parentElement;
  const set = (height: number): void => {
    const most = Math.max(LEAST_PX, window.innerHeight - LEFT_ABOVE_PX);
    const px = Math.round(Math.min(most, Math.max(LEAST_PX, height)));
    whole()?.style.setProperty("--time-height", `${px}px`);
    grip.setAttribute("aria-valuemin", String(LEAST_PX));
    grip.setAttribute("aria-valuemax", String(most));
    grip.setAttribute("aria-valuenow", String(px));
  };
  const reset = (): void => {
    whole()?.style.removeProperty("--time-height");
    grip.removeAttribute("aria-valuenow");
  };
  grip.addEventListener("pointerdown", (event) => {
    grip.setPointerCapture(event.pointerId);
    event.preventDefault();
    grip.focus();
  });
  grip.addEventListener("pointermove", (event) => grip.hasPointerCapture(event.pointerId) && set(pane().getBoundingClientRect().bottom - event.clientY));
  grip.addEventListener("dblclick", reset);
  grip.addEventListener("keydown", (event) => {
    if (event.key === "Escape") reset();
    else if (event.key === "ArrowUp" || event.key === "ArrowDown") set(pane().clientHeight + (event.key === "ArrowUp" ? STEP_PX : -STEP_PX));
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  return grip;
};
