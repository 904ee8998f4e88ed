// Where the log comes from: inside this page, from the server that handed the page out, or from the reader's disk.

import "./style.css";
import { App } from "./app";
import type { Origin } from "./read/protocol";

const root = document.getElementById("app");
if (!root) throw new Error("the page has no place to draw in");
const app = new App(root);

const inlined = document.getElementById("log");
const served = new URLSearchParams(location.search).get("log");
const besides = document.getElementById("log-b");
const servedBeside = new URLSearchParams(location.search).get("b");

/** A log from where the page came: a link must not make it fetch from elsewhere. */
const fromHere = (address: string): Origin | undefined => {
  const url = new URL(address, location.href);
  return url.origin === location.origin ? { kind: "url", name: url.pathname.replace(/^.*\//, "") || "log", url: url.href } : undefined;
};

/** A log inside the page. A second copy of it is of no use, so it is taken out. */
const fromPage = (element: HTMLElement, name: string): Origin => {
  element.remove();
  return { kind: "base64", name: element.dataset.name ?? name, text: element.textContent ?? "" };
};

const first = inlined?.textContent?.trim() ? fromPage(inlined, "log.mcap") : served === null ? undefined : fromHere(served);
const second = besides?.textContent?.trim() ? fromPage(besides, "log-b.mcap") : servedBeside === null ? undefined : fromHere(servedBeside);
if (first) app.open(first);
if (first && second) app.compare(second);
