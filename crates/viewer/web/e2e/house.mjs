// What the browser tests share: a page, a log, a server on loopback, and a browser that goes nowhere else.

import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

import { deriver } from "./derived.mjs";

export const page = readFileSync(new URL("../dist/index.html", import.meta.url));

/** The page with a block in it, right before the place that it draws in. */
const withBlock = (block) => page.toString().replace('<div id="app">', () => `${block}<div id="app">`);

/** The page as a server hands it out, with the word where its logs are. */
const told = (...names) => {
  const side = (name, i) => [["a", "b"][i], { name, log: `${["a", "b"][i]}/log`, derived: `${["a", "b"][i]}/derived` }];
  return withBlock(`<script type="application/json" id="served">${JSON.stringify(Object.fromEntries(names.map(side)))}</script>`);
};

/** Serves the bare page at /, with a log at /one/, with two at /two/; logs by ranges, and what is derived from them. */
export const serve = async (log, beside) => {
  const { derive, close } = await deriver([log, beside]);
  return new Promise((resolve) => {
    const pages = { "/": page, "/one/": told("run.mcap"), "/two/": told("run.mcap", "other.mcap") };
    const server = createServer(async (request, response) => {
      const { pathname } = new URL(request.url, "http://localhost");
      if (pages[pathname]) return response.writeHead(200, { "Content-Type": "text/html" }).end(pages[pathname]);
      const [, side, derived] = /^\/(?:one|two)\/([ab])\/derived\/(.+)$/.exec(pathname) ?? [];
      if (derived) {
        const { status, type, body } = await derive(derived, side);
        return response.writeHead(status, { "Content-Type": type }).end(body);
      }
      const bytes = { a: log, b: beside }[/^\/(?:one|two)\/([ab])\/log$/.exec(pathname)?.[1]];
      if (!bytes) return response.writeHead(404).end();
      const range = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "");
      if (!range) return response.writeHead(200).end(bytes);
      const [from, to] = [Number(range[1]), Math.min(Number(range[2]), bytes.length - 1)];
      response.writeHead(206, { "Content-Range": `bytes ${from}-${to}/${bytes.length}` }).end(bytes.subarray(from, to + 1));
    });
    server.listen(0, "127.0.0.1", () => resolve({ url: `http://127.0.0.1:${server.address().port}/`, close: () => (close(), server.close()) }));
  });
};

/** The page with a log inside, as it is mailed, and what is derived from it. */
export const inlined = (log, name, derived) =>
  withBlock(
    `<script type="application/octet-stream;base64" id="log" data-name="${name}">${log.toString("base64")}</script>` +
      (derived ? `<script type="application/json" id="derived">${JSON.stringify(derived)}</script>` : ""),
  );

export const browser = () =>
  chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });

/** Opens an address, and keeps what went wrong there and what it asked for. */
export const visit = async (of, url, options = {}) => {
  const context = await of.newContext({ viewport: { width: 1366, height: 768 }, colorScheme: "light", acceptDownloads: true, ...options });
  const tab = await context.newPage();
  const errors = [];
  const asked = [];
  tab.on("pageerror", (error) => errors.push(error.message));
  tab.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  tab.on("request", (request) => asked.push(request.url()));
  await tab.goto(url);
  return { tab, context, errors, asked };
};

export const ready = (tab) => tab.waitForFunction(() => document.documentElement.dataset.ready === "true" && document.documentElement.dataset.drawn !== undefined);
