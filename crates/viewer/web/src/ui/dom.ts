// Elements, made of parts. Text from a log goes in as text and never as markup.

/** Of a longer text the beginning is shown: a field may hold a book. */
const LONGEST_TEXT = 1000;
/** What cannot be seen, or turns round what is written beside it; line breaks and tabs may stay. */
const UNSEEN = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u2069\ufeff]/g;

const unseen = (character: string): string => `⟨U+${character.charCodeAt(0).toString(16).toUpperCase().padStart(4, "0")}⟩`;

/** Text as it can be shown: nothing in it hides, or lets other text run backwards. */
export const legible = (text: string, most = LONGEST_TEXT): string => {
  const shown = text.length > most ? text.slice(0, most) : text;
  const seen = shown.replace(UNSEEN, unseen);
  return text.length > most ? `${seen}… (${text.length - most} characters more)` : seen;
};

type Part = Node | string | number | undefined | false;

interface Attributes {
  [name: string]: string | number | boolean | undefined | ((event: never) => void);
}

/** Attributes that are read, not used. */
const SHOWN: ReadonlySet<string> = new Set(["title", "aria-label"]);

/** An element with attributes, listeners (`onclick`) and children. */
export const h = <K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...parts: readonly (Part | readonly Part[])[]
): HTMLElementTagNameMap[K] => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else element.setAttribute(name, value === true ? "" : typeof value === "string" && SHOWN.has(name) ? legible(value) : String(value));
  }
  for (const part of parts.flat()) {
    if (part === undefined || part === false) continue;
    element.append(part instanceof Node ? part : legible(String(part)));
  }
  return element;
};

const SVG = "http://www.w3.org/2000/svg";

export const s = <K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number | undefined> = {},
  ...parts: readonly (Node | string)[]
): SVGElementTagNameMap[K] => {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) if (value !== undefined) element.setAttribute(name, String(value));
  element.append(...parts.map((part) => (typeof part === "string" ? legible(part) : part)));
  return element;
};

/** Hands a file to the reader of the page. */
export const save = (name: string, content: Blob): void => {
  const url = URL.createObjectURL(content);
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
};
