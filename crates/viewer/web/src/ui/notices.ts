// What the page says of itself: a banner above all, and a hint beside the pointer.

import { h } from "./dom";

export class Banner {
  readonly element = h("div", { class: "banner", role: "status" });

  say(kind: string, text: string): void {
    this.element.className = `banner ${kind}`;
    this.element.textContent = text;
    this.element.hidden = text === "";
  }
}

export class Hint {
  readonly element = h("div", { class: "hint", role: "tooltip" });

  show(text: string | undefined, x: number, y: number): void {
    const { element } = this;
    element.hidden = text === undefined;
    if (text === undefined) return;
    element.textContent = text;
    element.style.left = `${Math.min(window.innerWidth - element.offsetWidth - 8, Math.max(8, x + 12))}px`;
    element.style.top = `${y - 34}px`;
  }
}
