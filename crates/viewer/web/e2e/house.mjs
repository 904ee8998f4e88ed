// What the browser tests share: a page, a log, a server on loopback, and a browser that goes nowhere else.

import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";

export const page = readFileSync(new URL("../dist/index.html", import.meta.url));

/** Serves the page at / and logs, by ranges, at /log and /log-b. */
export const serve = (log, beside) =>
  new Promise((resolve) => {
    const server = createServer((request, response) => {
      const { pathname } = new URL(request.url, "http://localhost");
      if (pathname === "/") return response.writeHead(200, { "Content-Type": "text/html" }).end(page);
      const bytes = { "/log": log, "/log-b": beside }[pathname];
      if (!bytes) return response.writeHead(404).end();
      const range = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "");
      if (!range) return response.writeHead(200).end(bytes);
      const [from, to] = [Number(range[1]), Math.min(Number(range[2]), bytes.length - 1)];
      response.writeHead(206, { "Content-Range": `bytes ${from}-${to}/${bytes.length}` }).end(bytes.subarray(from, to + 1));
    });
    server.listen(0, "127.0.0.1", () => resolve({ url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() }));
  });

/** The page with a log inside, as it is mailed. */
export const inlined = (log, name) =>
  page
    .toString()
    .replace("</body>", () => `<script type="application/octet-stream;base64" id="log" data-name="${name}">${log.toString("base64")}</script></body>`);

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
