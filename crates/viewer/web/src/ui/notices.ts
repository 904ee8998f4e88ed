// What the page says of itself: a banner above all, and a hint beside the pointer.

import { h, legible } from "./dom";

export class Banner {
  readonly element = h("div", { class: "banner", role: "status" });

  say(kind: string, text: string): void {
    this.element.className = `banner ${kind}`;
    this.element.textContent = legible(text);
    this.element.hidden = text === "";
  }
}

const LONGEST_HINT = 240;

export class Hint {
  readonly element = h("div", { class: "hint", role: "tooltip" });

  show(text: string | undefined, x: number, y: number): void {
    const { element } = this;
    element.hidden = text === undefined;
    if (text === undefined) return;
    element.textContent = legible(text, LONGEST_HINT);
    element.style.left = `${Math.min(window.innerWidth - element.offsetWidth - 8, Math.max(8, x + 12))}px`;
    element.style.top = `${y - 34}px`;
  }
}

const TOAST_MS = 3500;

/** A word that goes away by itself. */
export class Toast {
  readonly element = h("div", { class: "toast", role: "status", hidden: true });
  private timer: number | undefined;

  say(text: string): void {
    this.element.textContent = legible(text);
    this.element.hidden = false;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => (this.element.hidden = true), TOAST_MS);
  }
}
