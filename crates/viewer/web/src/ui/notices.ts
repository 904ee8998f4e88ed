// What the page says of itself: a banner above all, and a hint beside the pointer.

import { h, legible } from "./dom";

/** How a page that is mailed gets what its log has only as digests. */
export const PUT_IN = "wisdom report LOG --html FILE --planes all --families --prices all";

/** What is to be said of one log. */
interface Said {
  kind: string;
  text: string;
}

/** A line for each log of which there is something to say. */
export class Banner {
  readonly element = h("div", { class: "banner", role: "status", hidden: true });
  private readonly said: Record<"a" | "b", Said> = { a: { kind: "", text: "" }, b: { kind: "", text: "" } };
  private two = false;

  say(of: "a" | "b", kind: string, text: string): void {
    this.said[of] = { kind, text };
    this.show();
  }

  /** Whether there are two logs, so that a line must say which of them it is about. */
  beside(two: boolean): void {
    this.two = two;
    if (!two) this.said.b = { kind: "", text: "" };
    this.show();
  }

  private show(): void {
    const { a, b } = this.said;
    const lines = [{ ...a, name: this.two ? "A: " : "" }, { ...b, name: "B: " }].filter(({ text }) => text !== "");
    this.element.replaceChildren(...lines.map(({ kind, name, text }) => h("p", { class: kind }, legible(`${name}${text}`))));
    this.element.hidden = lines.length === 0;
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
