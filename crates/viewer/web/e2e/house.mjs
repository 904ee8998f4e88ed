// What the browser tests share: a page, a log, a server on loopback, and a browser that goes nowhere else.

import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

export const page = readFileSync(new URL("../dist/index.html", import.meta.url));

/** The page with a block in it, right before the place that it draws in. */
const withBlock = (block) => page.toString().replace('<div id="app">', () => `${block}<div id="app">`);

/** Serves the bare page, as any web server could. */
export const serve = () =>
  new Promise((resolve) => {
    const server = createServer((request, response) => (request.url === "/" ? response.writeHead(200, { "Content-Type": "text/html" }).end(page) : response.writeHead(404).end()));
    server.listen(0, "127.0.0.1", () => resolve({ url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() }));
  });

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
