// What the browser tests share: a page, a log, a server on loopback, and a browser that goes nowhere else.

import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

export const page = readFileSync(new URL("../dist/index.html", import.meta.url));

/** The page with a block in it, where the command puts it: at the end of the body. */
const withBlock = (block) => {
  const whole = page.toString();
  const end = whole.lastIndexOf("</body>");
  return `${whole.slice(0, end)}${block}${whole.slice(end)}`;
};

/** Serves the bare page, as any web server could. */
export const serve = () =>
  new Promise((resolve) => {
    const server = createServer((request, response) => (request.url === "/" ? response.writeHead(200, { "Content-Type": "text/html" }).end(page) : response.writeHead(404).end()));
    server.listen(0, "127.0.0.1", () => resolve({ url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() }));
  });

const bytesBlock = (id, name, bytes) => (bytes ? `<script type="application/octet-stream;base64" id="${id}" data-name="${name}">${bytes.toString("base64")}</script>` : "");

/** The page with a log inside, as it is mailed, and what is derived from it, with a log of planes; and a second of all that. */
export const inlined = (log, name, derived, planes, other) =>
  withBlock(
    bytesBlock("log", name, log) +
      bytesBlock("planes", "planes", planes) +
      bytesBlock("log-b", other?.name, other?.log) +
      bytesBlock("planes-b", "planes-b", other?.planes) +
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
