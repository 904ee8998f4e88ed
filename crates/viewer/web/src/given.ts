// What came with the page: logs inside it, or the word of the server that handed it out where they are.

import { member, text } from "./derived/json";
import type { Supply } from "./derived/source";
import type { Origin } from "./read/protocol";

/** A log to open, and where what is derived from it comes from. */
export interface Given {
  origin: Origin;
  supply: Supply;
}

/** The logs that came with the page, first and second. */
export const given = (): { a?: Given; b?: Given } => {
  const derived = json("derived");
  const [a, b] = [inlined("log", "log.mcap", member(derived, "a"), taken("planes")), inlined("log-b", "log-b.mcap", member(derived, "b"), taken("planes-b"))];
  if (a) return { a, b };
  const served = json("served");
  return { a: fromServer(member(served, "a")), b: fromServer(member(served, "b")) };
};

/** A log inside the page, with what is derived from it, and the planes of that. */
const inlined = (id: string, name: string, block: unknown, planes: Origin | undefined): Given | undefined => {
  const origin = taken(id, name);
  return origin && { origin, supply: block === undefined ? { kind: "none" } : { kind: "embedded", block, planes } };
};

/** Bytes inside the page. A second copy of them is of no use, so they are taken out. */
const taken = (id: string, name = id): Origin | undefined => {
  const element = document.getElementById(id);
  const words = element?.textContent?.trim();
  if (!element || !words) return undefined;
  element.remove();
  return { kind: "base64", name: element.dataset.name ?? name, text: words };
};

/** A block of JSON in the page; nothing if there is none, or none that can be read. */
const json = (id: string): unknown => {
  const words = document.getElementById(id)?.textContent;
  if (!words) return undefined;
  try {
    return JSON.parse(words) as unknown;
  } catch {
    return undefined;
  }
};

const fromServer = (one: unknown): Given | undefined => {
  const log = text(member(one, "log"));
  if (log === undefined) return undefined;
  const [url, folder] = [new URL(log, location.href), text(member(one, "derived"))];
  // Never from elsewhere than where the page came from.
  if (url.origin !== location.origin) return undefined;
  const supply: Supply = folder !== undefined && new URL(folder, location.href).origin === location.origin ? { kind: "served", folder } : { kind: "none" };
  return { origin: { kind: "url", name: text(member(one, "name")) ?? "log", url: url.href }, supply };
};
