// The page in a real browser: opened, stepped, asked, cut, dropped; held against what the log says.
//
// Usage: node e2e/run.mjs [--shots FOLDER]. Needs a Chromium (CHROMIUM=path), and the `wisdom` command (WISDOM=path, or what Cargo built)
// with the page of dist/index.html inside.

import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { ground } from "./ground.mjs";
import { browser, inlined, ready, serve, visit } from "./house.mjs";
import { odd } from "./odd.mjs";
import { page } from "./page.mjs";
import { otherRun, sample as samplePath, view } from "./rust.mjs";
import { runs } from "./runs.mjs";
import { truth } from "./truth.mjs";
import { unlike } from "./unlike.mjs";

const sample = readFileSync(samplePath(5));
const flag = process.argv.indexOf("--shots");
const shots = flag > 0 ? process.argv[flag + 1] : undefined;
if (shots) mkdirSync(shots, { recursive: true });

const other = otherRun("pcr6", mkdtempSync(join(tmpdir(), "wisdom-")));
const server = await serve();
const alone = await view(samplePath(5));
// Beside a run that was decided by an older version, of which nothing can be made again; and beside one under another rule.
const aged = await view(samplePath(5), samplePath(4));
const pair = await view(samplePath(5), other);
const chromium = await browser();
const timings = {};
let passed = 0;
let failed = 0;

/** One test: what it proves, and how. Returns what went wrong. */
const tried = async (body) => {
  const open = [];
  const at = async (url, options) => {
    const visited = await visit(chromium, url, options);
    open.push(visited);
    return visited;
  };
  try {
    await body(at);
    for (const { errors } of open) assert.deepEqual(errors, []);
    return undefined;
  } catch (error) {
    return error.message.split("\n").slice(0, 12).join("\n      ");
  } finally {
    for (const { context } of open) await context.close();
  }
};
const proves = async (what, body) => {
  const wrong = await tried(body);
  if (wrong === undefined) passed += 1;
  else failed += 1;
  console.log(wrong === undefined ? `ok    ${what}` : `FAIL  ${what}\n      ${wrong}`);
};
const shoot = async (tab, name) => shots && (await tab.waitForTimeout(200), tab.screenshot({ path: join(shots, `${name}.png`) }));
const title = (tab) => tab.locator(".title h2").innerText();
const drawn = (tab, number) => tab.waitForFunction((n) => document.documentElement.dataset.drawn === String(n), number);
const served = alone.url;
const two = aged.url;

await proves("a served log opens, and asks nobody else for anything", async (at) => {
  const { tab, asked } = await at(served);
  await ready(tab);
  assert.equal(await title(tab), "Decision 0 of 0 … 4");
  assert.equal(await tab.locator(".mission").innerText(), "paper");
  assert.match(await tab.locator(".pill").innerText(), /complete/);
  assert.deepEqual(asked.filter((url) => !url.startsWith(served) && !url.startsWith("blob:") && !url.startsWith("data:")), []);
  await shoot(tab, "open");
});

await proves("the page paints within a second, and no task holds it up for longer than a frame may last", async (at) => {
  const { tab } = await at("about:blank");
  await tab.addInitScript(() => {
    window.long = [];
    new PerformanceObserver((list) => window.long.push(...list.getEntries().map(({ duration }) => duration))).observe({ entryTypes: ["longtask"] });
  });
  await tab.goto(served);
  await ready(tab);
  timings.firstPaintMs = await tab.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
  timings.readyMs = await tab.evaluate(() => performance.now());
  await tab.evaluate(() => (window.long = []));
  for (const key of ["ArrowRight", "ArrowRight", "ArrowRight", "ArrowRight", "2", "3", "4", "1", "Home", "t", "l", "l", "End", "t"]) {
    await tab.keyboard.press(key);
    await tab.waitForTimeout(120);
  }
  timings.longTasksMs = await tab.evaluate(() => window.long.map(Math.round));
  assert.ok(timings.firstPaintMs < 1000, `first paint after ${timings.firstPaintMs} ms`);
  // Tasks above 50 ms are what the browser calls long; a busy machine may add one of its own.
  assert.ok(Math.max(0, ...timings.longTasksMs) < 120, `tasks of ${timings.longTasksMs} ms`);
});

await proves("keys step through the run, and the address follows", async (at) => {
  const { tab } = await at(served);
  await ready(tab);
  await tab.keyboard.press("ArrowRight");
  await drawn(tab, 1);
  assert.equal(await title(tab), "Decision 1 of 0 … 4");
  await tab.waitForFunction(() => location.hash === "#d=1");
  await tab.keyboard.press("End");
  await drawn(tab, 4);
  assert.equal(await title(tab), "Decision 4 of 0 … 4");
  await tab.keyboard.press("ArrowRight");
  assert.equal(await title(tab), "Decision 4 of 0 … 4");
  await tab.keyboard.press("Home");
  await drawn(tab, 0);
  assert.equal(await title(tab), "Decision 0 of 0 … 4");
  await tab.keyboard.press("Space");
  await drawn(tab, 2);
  await tab.keyboard.press("Space");
});

await proves("a link leads to its moment", async (at) => {
  const { tab } = await at(`${served}#d=3`);
  await ready(tab);
  await drawn(tab, 3);
  assert.equal(await title(tab), "Decision 3 of 0 … 4");
});

await proves("the goals listed are those of the log, and open by key", async (at) => {
  const { tab } = await at(`${served}#d=1`);
  await ready(tab);
  await drawn(tab, 1);
  const rows = tab.locator(".goal-table tr.goal");
  assert.equal(String(await rows.count()), await tab.locator("#tab-goals .count").innerText());
  await tab.keyboard.press("g");
  await tab.keyboard.press("ArrowDown");
  await tab.keyboard.press("Enter");
  await tab.waitForSelector(".detail");
  assert.match(await tab.locator(".detail .credit-key").innerText(), /dem .*%/);
  await shoot(tab, "goal");
  await tab.keyboard.press("Escape");
  await tab.keyboard.press("/");
  await tab.keyboard.type("no such goal");
  assert.equal(await rows.count(), 0);
});

await proves("the pointer asks a cell for every layer", async (at) => {
  const { tab } = await at(served);
  await ready(tab);
  const box = await tab.locator("canvas.map").boundingBox();
  await tab.mouse.move(box.x + box.width * 0.65, box.y + box.height / 2);
  await tab.waitForFunction(() => {
    const values = [...document.querySelectorAll(".readout .v")].map((one) => one.textContent);
    return values.length > 3 && !values.includes("…");
  });
  const told = await tab.locator(".readout").innerText();
  assert.match(told, /cell \(\d+, \d+\)/);
  assert.match(told, /interest\s+0?\.?\d/);
  assert.match(told, /as read\s+u\s[^]*temperature\s/);
});

await proves("the map has the colours of its legend", async (at) => {
  const { tab } = await at(served);
  await ready(tab);
  const colours = await tab.evaluate(() => {
    const canvas = document.querySelector("canvas.map");
    const { data } = canvas.getContext("2d").getImageData(canvas.width * 0.35, canvas.height * 0.1, canvas.width * 0.5, canvas.height * 0.8);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4 * 31) seen.add((data[i] >> 4) * 256 + (data[i + 1] >> 4) * 16 + (data[i + 2] >> 4));
    return seen.size;
  });
  assert.ok(colours > 40, `${colours} colours`);
});

await proves("the ground stands up in three dimensions", async (at) => {
  const { tab } = await at(`${served}#d=1`);
  await ready(tab);
  await drawn(tab, 1);
  await tab.keyboard.press("v");
  await tab.waitForTimeout(800);
  const colours = await tab.evaluate(() => {
    const canvas = document.querySelector("canvas.solid");
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4 * 31) seen.add((data[i] >> 4) * 256 + (data[i + 1] >> 4) * 16 + (data[i + 2] >> 4));
    return seen.size;
  });
  assert.ok(colours > 40, `${colours} colours`);
  await shoot(tab, "solid");
  await tab.keyboard.press("v");
  await tab.waitForTimeout(200);
  assert.ok(await tab.locator("canvas.map").isVisible());
});

await proves("a page from disk with the log inside needs no server", async (at) => {
  const folder = mkdtempSync(join(tmpdir(), "wisdom-viewer-"));
  const file = join(folder, "report.html");
  writeFileSync(file, inlined(sample, "paper.mcap"));
  const { tab, asked } = await at(pathToFileURL(file).href);
  await ready(tab);
  assert.equal(await title(tab), "Decision 0 of 0 … 4");
  assert.deepEqual(asked.filter((url) => /^https?:/.test(url)), []);
});

await proves("a file that was cut short and is dropped on the page shows what was saved", async (at) => {
  const { tab } = await at(server.url);
  await tab.waitForSelector(".welcome");
  await shoot(tab, "welcome");
  const cut = sample.subarray(0, Math.floor(sample.length * 0.7)).toString("base64");
  const dropped = await tab.evaluateHandle((text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const transfer = new DataTransfer();
    transfer.items.add(new File([bytes], "cut.mcap.part"));
    return transfer;
  }, cut);
  await tab.dispatchEvent("body", "drop", { dataTransfer: dropped });
  await ready(tab);
  const said = await tab.locator(".banner").innerText();
  assert.match(said, /^Cut short at byte \d+ of \d+: .* decisions? recovered\. /);
  assert.match(await tab.locator(".pill").innerText(), /cut short/);
  await shoot(tab, "cut");
});

await proves("text of a log is never markup", async (at) => {
  const evil = Buffer.from(sample);
  const { tab } = await at(server.url);
  await tab.evaluate((text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const transfer = new DataTransfer();
    transfer.items.add(new File([bytes], "<img src=x onerror=document.title=1>.mcap"));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
  }, evil.toString("base64"));
  await ready(tab);
  assert.equal(await tab.locator("img").count(), 0);
  assert.match(await tab.locator(".facts-line").innerText(), /<img src=x/);
});

await proves("two runs stand side by side under one cursor", async (at) => {
  const { tab } = await at(two);
  await ready(tab);
  await tab.waitForFunction(() => document.documentElement.dataset.other === "true");
  await tab.waitForSelector(".page-other .sides");
  assert.match(await tab.locator(".page-other").innerText(), /differ in decision version/);
  const half = () => tab.locator("canvas.map").evaluate((canvas) => canvas.toDataURL().length);
  await tab.waitForTimeout(400);
  await shoot(tab, "two-runs");
  const before = await half();
  for (let i = 0; i < 4; i++) await tab.keyboard.press("[");
  await tab.waitForTimeout(300);
  assert.notEqual(await half(), before, "the wipe moves");
  await tab.locator('select[aria-label="Shown of the layer"]').selectOption({ label: "A less B" });
  await tab.waitForFunction(() => document.querySelector(".legend").textContent.includes(": A less B"));
  await tab.getByRole("button", { name: /First divergence/ }).click();
  await tab.waitForFunction(() => document.querySelector(".page-other").textContent.includes("Chosen otherwise"));
  await tab.getByRole("button", { name: "Close B" }).click();
  await tab.waitForFunction(() => document.documentElement.dataset.other === undefined);
  await tab.waitForSelector("#tab-other", { state: "detached" });
});

await proves("goals are saved as CSV", async (at) => {
  const { tab } = await at(served);
  await ready(tab);
  await tab.locator(".menu summary").click();
  const [download] = await Promise.all([tab.waitForEvent("download"), tab.getByRole("button", { name: "CSV" }).click()]);
  const lines = readFileSync(await download.path(), "utf8").trim().split("\n");
  assert.match(lines[0], /^decision,time_s,goal,directive/);
  assert.equal(String(lines.length - 1), await tab.locator("#tab-goals .count").innerText());
});

await proves("it is dark where the system is", async (at) => {
  const { tab } = await at(`${served}#d=2`, { colorScheme: "dark" });
  await ready(tab);
  await drawn(tab, 2);
  const [r, g, b] = (await tab.evaluate(() => getComputedStyle(document.querySelector("aside")).backgroundColor)).match(/\d+/g).map(Number);
  assert.ok(r + g + b < 120, "the panel is dark");
  await tab.keyboard.press("3");
  await shoot(tab, "dark");
});

await runs({ proves, shoot, drawn, one: served, two });
await page({ proves, shoot, drawn, server, one: served, two, sample, log: samplePath(5) });
await odd({ proves, shoot, bare: server.url, sample, timings });
await ground({ proves, shoot, drawn, server, one: served, two, sample });

await unlike({ proves, shoot, drawn, bare: server.url, one: served, two, sample, other });
await truth({ proves, shoot, drawn, one: served, two: pair.url, rust: alone, samples: [samplePath(5), other] });

await chromium.close();
for (const one of [server, alone, aged, pair]) one.close();
console.log(JSON.stringify(timings));
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed > 0 ? 1 : 0;
