// Elements, made of parts. Text from a log goes in as text and never as markup.

type Part = Node | string | number | undefined | false;

interface Attributes {
  [name: string]: string | number | boolean | undefined | ((event: never) => void);
}

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
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  for (const part of parts.flat()) {
    if (part === undefined || part === false) continue;
    element.append(part instanceof Node ? part : String(part));
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
  element.append(...parts);
  return element;
};

/** Hands a file to the reader of the page. */
export const save = (name: string, content: Blob): void => {
  const url = URL.createObjectURL(content);
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
};
