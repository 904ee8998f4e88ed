// What came with the page: logs inside it, or the word of the server that handed it out where they are.

import type { Origin } from "./read/protocol";

/** A log to open, and the folder of what the server derives from it. */
export interface Given {
  origin: Origin;
  derived?: string;
}

/** The logs that came with the page, first and second. */
export const given = (): { a?: Given; b?: Given } => {
  const [a, b] = [inlined("log", "log.mcap"), inlined("log-b", "log-b.mcap")];
  if (a) return { a, b };
  const served = json("served");
  return { a: fromServer(member(served, "a")), b: fromServer(member(served, "b")) };
};

/** A log inside the page. A second copy of it is of no use, so it is taken out. */
const inlined = (id: string, name: string): Given | undefined => {
  const element = document.getElementById(id);
  const text = element?.textContent?.trim();
  if (!element || !text) return undefined;
  element.remove();
  return { origin: { kind: "base64", name: element.dataset.name ?? name, text } };
};

/** A block of JSON in the page; nothing if there is none, or none that can be read. */
export const json = (id: string): unknown => {
  const text = document.getElementById(id)?.textContent;
  if (!text) return undefined;
  try {
    return JSON.parse(text) as unknown;
  } catch {
    return undefined;
  }
};

/** A member of what may be an object. */
export const member = (of: unknown, name: string): unknown =>
  typeof of === "object" && of !== null ? (of as Record<string, unknown>)[name] : undefined;

const fromServer = (one: unknown): Given | undefined => {
  const [name, log, derived] = [member(one, "name"), member(one, "log"), member(one, "derived")];
  if (typeof log !== "string") return undefined;
  const url = new URL(log, location.href);
  // Never from elsewhere than where the page came from.
  if (url.origin !== location.origin) return undefined;
  return {
    origin: { kind: "url", name: typeof name === "string" ? name : "log", url: url.href },
    ...(typeof derived === "string" ? { derived } : {}),
  };
};
