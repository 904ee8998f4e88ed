// The ground: derived layers, what is told of a cell, ways and prices, three dimensions, figures; held against what the server
// answers, whatever its numbers are.

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { inlined, ready } from "./house.mjs";

const layer = (tab) => tab.locator('select[aria-label="Layer"]');
const aspect = (tab) => tab.locator('select[aria-label="Shown of the layer"]');
const legend = (tab, words) => tab.waitForFunction((text) => document.querySelector(".legend").textContent.includes(text), words);
const both = (tab) => tab.waitForFunction(() => document.documentElement.dataset.other === "true");
const offered = (tab, group) => tab.waitForSelector(`select[aria-label="Layer"] optgroup[label="${group}"]`, { state: "attached" });
const press = async (tab, keys) => {
  for (const key of keys) await tab.keyboard.press(key);
};

/** What the server says: JSON, or a plane. */
const ask = async (page, path) => (await fetch(new URL(`a/derived/${path}`, page))).json();
const plane = async (page, path) => {
  const bytes = await (await fetch(new URL(`a/derived/plane/${path}`, page))).arrayBuffer();
  const [row, col, rows, cols] = new Uint32Array(bytes, 0, 4);
  const values = new Float32Array(bytes, 16);
  return { rows, cols, at: (r, c) => values[(r - row) * cols + c - col] };
};
/** As the page writes a number of unknown size. */
const plain = (value) => {
  const size = Math.abs(value);
  return value === 0 ? "0" : size >= 100 ? value.toFixed(0) : size >= 1 ? value.toFixed(2) : size >= 1e-3 ? value.toFixed(4) : value.toExponential(1);
};
/** Keys to a cell from the rover's, and what is told there. */
const probe = async (tab, keys) => {
  await tab.keyboard.press("m");
  await press(tab, keys);
  await tab.waitForFunction(() => {
    const values = [...document.querySelectorAll(".readout .v")].map((one) => one.textContent);
    return values.length > 3 && !values.includes("…");
  });
  const told = await tab.locator(".readout").innerText();
  const [, row, col] = /cell \((\d+), (\d+)\)/.exec(told).map(Number);
  return { told, row, col };
};
/** Colours seen in a canvas, coarsely. */
const colours = (tab, selector) =>
  tab.evaluate((of) => {
    const canvas = document.querySelector(of);
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4 * 7) sum = (sum * 31 + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1e9;
    return sum;
  }, selector);
/** Waits until a canvas is drawn otherwise than it was. */
const changed = async (tab, selector, was, what) => {
  for (let i = 0; i < 40; i++) {
    const now = await colours(tab, selector);
    if (now !== was) return now;
    await tab.waitForTimeout(50);
  }
  return assert.fail(`${what}: ${selector} stays as it was`);
};
const saved = async (tab, name) => {
  await tab.locator(".menu summary").click();
  const [download] = await Promise.all([tab.waitForEvent("download"), tab.getByRole("button", { name }).click()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
};

export const ground = async ({ proves, shoot, drawn, server, one, two, sample }) => {
  await proves("derived layers are offered by what they are about, and shown by the server's own values", async (at) => {
    const { tab, asked } = await at(one);
    await ready(tab);
    for (const group of ["interest", "readings as logged", "layers as used", "uncertainty", "ground", "masses", "credits"]) await offered(tab, group);
    const index = await ask(one, "index");
    for (const { name, group } of index.planes.filter(({ name }) => name !== "interest")) {
      assert.equal(await tab.locator(`select[aria-label="Layer"] option[value="derived:${name}"]`).count(), 1, `${name} of ${group}`);
    }
    const before = await colours(tab, "canvas.map");
    await layer(tab).selectOption("derived:ignorance");
    await legend(tab, "ignorance");
    await changed(tab, "canvas.map", before, "another layer");
    assert.deepEqual(await tab.locator(".legend .ticks span").allInnerTexts(), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
    await layer(tab).selectOption(`derived:credit-${index.experts[0]}`);
    await legend(tab, "-1.00");
    assert.ok((await tab.locator(".legend").innerText()).startsWith(index.planes.find(({ name }) => name === `credit-${index.experts[0]}`).label));
    assert.deepEqual(await tab.locator(".legend .ticks span").allInnerTexts(), ["-1.00", "-0.50", "0.00", "0.50", "1.00"]);
    assert.deepEqual(asked.filter((url) => !url.startsWith(one) && !/^(blob|data):/.test(url)), []);
  });

  await proves("a layer of classes has a legend of names, and no colours between them", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    await offered(tab, "layers as used");
    const { classes } = (await ask(one, "index")).planes.find(({ name }) => name === "texture");
    await layer(tab).selectOption("derived:texture");
    await tab.waitForSelector(".legend .classes");
    const names = await tab.locator(".legend .classes li").allInnerTexts();
    assert.deepEqual(names, classes.map(({ value, name }) => (name.split(" ").includes(String(value)) ? name : `${value} ${name}`)).concat(names.length > classes.length ? ["no class"] : []));
    await tab.keyboard.press("s");
    await tab.waitForTimeout(300);
    const seen = await tab.evaluate(() => {
      const canvas = document.querySelector("canvas.map");
      const { data } = canvas.getContext("2d").getImageData(canvas.width * 0.4, canvas.height * 0.1, canvas.width * 0.5, canvas.height * 0.8);
      const counts = new Map();
      for (let i = 0; i < data.length; i += 4) {
        const colour = `${data[i]},${data[i + 1]},${data[i + 2]}`;
        counts.set(colour, (counts.get(colour) ?? 0) + 1);
      }
      const swatches = [...document.querySelectorAll(".legend .classes i")].map((one) => getComputedStyle(one).backgroundColor.match(/\d+/g).join(","));
      return { swatches, common: [...counts].filter(([, count]) => count > data.length / 4 / 60).map(([colour]) => colour) };
    });
    assert.ok(seen.common.length > 1, "more than one class is in sight");
    for (const colour of seen.common) assert.ok(seen.swatches.includes(colour), `${colour} is of no class`);
    await shoot(tab, "classes");
  });

  await proves("a cell tells each expert's masses and exact credit, as the server has them", async (at) => {
    const { tab } = await at(`${one}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    await offered(tab, "credits");
    const { told, row, col } = await probe(tab, ["Alt+ArrowDown", "Alt+ArrowRight", "Alt+ArrowRight"]);
    await tab.waitForSelector(".readout .credit-at");
    const answer = await ask(one, `cell/1/${row}/${col}`);
    const rows = await tab.locator(".experts tbody tr").allInnerTexts();
    assert.deepEqual(
      rows.map((text) => text.split(/\s+/)),
      answer.experts.map(({ name, masses, credit }) => [name, ...[masses.interesting, masses.not_interesting, masses.ignorance, masses.paradox].map((mass) => mass.toFixed(3)), credit === null ? "none" : credit.toFixed(4)]),
    );
    for (const name of ["ignorance", "conflict"]) assert.match(told, new RegExp(`${name}\\s+${plain(answer.planes[name]).replace(".", "\\.")}`), name);
    const found = await plane(one, "1/paradox");
    assert.match(told, new RegExp(`paradox\\s+${plain(found.at(row, col)).replace(".", "\\.")}`));
    await shoot(tab, "cell");
  });

  await proves("of a cell left quickly nothing is told", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    await offered(tab, "credits");
    const slow = [];
    await tab.route("**/derived/cell/**", async (route) => {
      slow.push(route.request().url());
      // The first answer is held until the second has come.
      await new Promise((resolve) => setTimeout(resolve, slow.length === 1 ? 900 : 50));
      await route.continue().catch(() => undefined);
    });
    await tab.keyboard.press("m");
    await press(tab, ["Alt+ArrowUp"]);
    await tab.waitForTimeout(200);
    await press(tab, ["Alt+ArrowUp", "Alt+ArrowUp"]);
    await tab.waitForSelector(".readout .credit-at");
    const row = Number(/cell \((\d+)/.exec(await tab.locator(".readout").innerText())[1]);
    const { experts } = await ask(one, slow.at(-1).split("/derived/")[1]);
    assert.match(slow.at(-1), new RegExp(`/cell/0/${row}/`));
    await tab.waitForTimeout(900);
    const credit = experts[0].credit === null ? "none" : experts[0].credit.toFixed(4);
    assert.equal(await tab.locator(".readout .credit-at").first().innerText(), credit);
    assert.equal(slow.length, 2, "cells passed over were not asked for");
  });

  await proves("any layer shows its change since the last decision, and A less B", async (at) => {
    const { tab } = await at(`${two}#d=2`);
    await ready(tab);
    await both(tab);
    await drawn(tab, 2);
    await layer(tab).selectOption("derived:temperature-u");
    await aspect(tab).selectOption("change");
    await legend(tab, "change of ");
    const [now, before] = [await plane(two, "2/temperature-u"), await plane(two, "1/temperature-u")];
    let most = 0;
    for (let row = 0; row < now.rows; row++) for (let col = 0; col < now.cols; col++) most = Math.max(most, Math.abs(now.at(row, col) - before.at(row, col)) || 0);
    most = Math.max(0.05, most);
    const last = Number(await tab.locator(".legend .ticks span").last().innerText());
    assert.ok(Math.abs(last - most) <= 0.01 * most, `${last} against ${most}`);
    await press(tab, ["m", "a"]);
    const other = await (await fetch(new URL("b/derived/index", two))).json();
    await legend(tab, other.planes ? ": A less B" : "Not both runs hold this map");
    await layer(tab).selectOption("read:temperature");
    await legend(tab, "temperature as read: A less B");
    await press(tab, ["Home", "m"]);
    await aspect(tab).selectOption("change");
    await legend(tab, "There is no decision before this one.");
  });

  await proves("a map that the server cannot give says why", async (at) => {
    const { tab, errors } = await at(one);
    await ready(tab);
    await offered(tab, "credits");
    await tab.route("**/derived/plane/**", (route) => route.fulfill({ status: 500, contentType: "application/json", body: '{"error":"the look <b>is</b> not in the log"}' }));
    await layer(tab).selectOption("derived:conflict");
    await legend(tab, "This map cannot be had: the look <b>is</b> not in the log");
    assert.equal(await tab.locator(".legend b").count(), 0);
    await layer(tab).selectOption("map:interest");
    await legend(tab, "interest");
    // The browser itself writes of the status.
    errors.splice(0, errors.length, ...errors.filter((text) => !/status of 500/.test(text)));
  });

  await proves("ways of the family are those of the server, or straight lines that say so", async (at) => {
    const { tab, errors } = await at(one);
    await ready(tab);
    const without = await colours(tab, "canvas.map");
    await tab.keyboard.press("w");
    await legend(tab, "alternative");
    await tab.waitForFunction(() => !document.querySelector(".legend").textContent.includes("not in the log"));
    await changed(tab, "canvas.map", without, "ways");
    const { plans } = await ask(one, "family/0");
    await shoot(tab, "alternatives");
    const svg = (await saved(tab, "Map as SVG")).bytes.toString();
    const shown = [...svg.matchAll(/<path[^>]*d="([^"]*)"[^>]*class="alternative"/g)].map(([, d]) => d.match(/[ML]/g).length);
    assert.ok(shown.length > 0, "an alternative is drawn");
    for (const cells of shown) assert.ok(plans.some((plan) => plan.cells.length === cells), `a way of ${cells} cells`);
    await tab.route("**/derived/family/**", (route) => route.fulfill({ status: 404, contentType: "application/json", body: '{"error":"no"}' }));
    await tab.keyboard.press("ArrowRight");
    await legend(tab, "ways of alternatives are not in the log");
    errors.splice(0, errors.length, ...errors.filter((text) => !/status of 404/.test(text)));
  });

  await proves("a goal left out tells its price, and the page goes on while it is worked out", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    const { left_out: left } = await ask(one, "prices/0");
    const goal = left.find(({ price }) => price.energy_j.least !== undefined && price.energy_j.confirmed);
    let give;
    const held = new Promise((resolve) => (give = resolve));
    await tab.route("**/derived/prices/**", async (route) => {
      await held;
      await route.continue();
    });
    const row = tab.locator("tr.goal.deferred").first();
    const name = await row.locator(".name").innerText();
    const price = left.find((one) => one.goal === name)?.price ?? goal.price;
    await row.click();
    await tab.getByRole("button", { name: "What would it have taken?" }).click();
    await tab.waitForFunction(() => document.querySelector(".price-tag").textContent.includes("Being worked out"));
    await tab.keyboard.press("ArrowRight");
    await drawn(tab, 1);
    await tab.keyboard.press("ArrowLeft");
    await drawn(tab, 0);
    give();
    await tab.waitForSelector(".prices");
    const told = await tab.locator(".price-tag").innerText();
    const energy = price.energy_j.least;
    assert.ok(told.includes(`${(energy / 1e3).toFixed(1)} kJ more`), `${told} for ${energy} J`);
    if (price.energy_j.confirmed) assert.match(told, /applied: it is in, and out at 1 % less/);
    await shoot(tab, "price");
  });

  await proves("both runs stand up under one cursor, and heights are stretched at will", async (at) => {
    const { tab } = await at(`${two}#d=1`);
    await ready(tab);
    await both(tab);
    await drawn(tab, 1);
    await tab.keyboard.press("v");
    await legend(tab, "heights ×");
    await tab.waitForTimeout(400);
    await shoot(tab, "solid-two");
    const first = await colours(tab, "canvas.solid");
    await press(tab, ["[", "[", "["]);
    const wiped = await changed(tab, "canvas.solid", first, "the wipe moves");
    await tab.locator('select[aria-label="Heights stretched by"]').selectOption("3");
    await legend(tab, "heights × 3");
    await changed(tab, "canvas.solid", wiped, "heights change");
    await press(tab, ["m", "b"]);
    await tab.waitForFunction(() => document.querySelector(".divide").style.left === "50%");
    await tab.waitForTimeout(300);
    await shoot(tab, "solid-halves");
    const { bytes } = await saved(tab, "Map as PNG");
    assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  });

  await proves("maps stand side by side, and the pointer asks the run that it is over", async (at) => {
    const { tab } = await at(`${two}#d=1`);
    await ready(tab);
    await both(tab);
    await tab.keyboard.press("b");
    await tab.waitForTimeout(300);
    const box = await tab.locator("canvas.map").boundingBox();
    const over = async (part) => {
      await tab.mouse.move(box.x + box.width * part, box.y + box.height * 0.5);
      await tab.waitForTimeout(250);
      return tab.locator(".readout").innerText();
    };
    const [a, b] = [await over(0.3), await over(0.8)];
    assert.match(a, /^A, cell/);
    assert.match(b, /^B, cell/);
    assert.equal(/cell (\(.*?\))/.exec(a)[1], /cell (\(.*?\))/.exec(b)[1], "the same cell in either half");
    await shoot(tab, "halves");
  });

  await proves("the map is saved as SVG: ground as a picture, all else as lines and words", async (at) => {
    const { tab, context } = await at(`${one}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    const { name, bytes } = await saved(tab, "Map as SVG");
    assert.match(name, /^paper-d1-map-interest\.svg$/);
    const svg = bytes.toString();
    assert.match(svg, /paper, decision 1 at 0:05 h: interest/);
    assert.match(svg, /href="data:image\/png;base64,/);
    assert.match(svg, /class="next-leg"/);
    assert.match(svg, /\d+ m<\/text>/);
    for (const goal of await tab.locator(".goal-table tr.next .name, .goal-table tr.planned .name").allInnerTexts()) assert.ok(svg.includes(`<title>${goal}</title>`), goal);
    assert.match(svg, /class="goal deferred"/);
    assert.doesNotMatch(svg, /<script|javascript:|https?:(?!\/\/www\.w3\.org)/);
    const other = await context.newPage();
    const file = join(mkdtempSync(join(tmpdir(), "wisdom-viewer-")), name);
    writeFileSync(file, bytes);
    await other.goto(pathToFileURL(file).href);
    assert.equal(await other.evaluate(() => document.documentElement.tagName), "svg");
    await shoot(other, "figure");
    const png = await saved(tab, "Map as PNG");
    assert.equal(png.bytes.subarray(1, 4).toString(), "PNG");
    assert.ok(png.bytes.readUInt32BE(16) > 900, "fine enough for print");
  });

  await proves("figures and tables are saved by keys alone", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    await tab.locator(".menu summary").focus();
    await tab.keyboard.press("Space");
    assert.ok(await tab.getByRole("button", { name: "Goals as CSV" }).isVisible());
    await tab.keyboard.press("Escape");
    assert.ok(!(await tab.getByRole("button", { name: "Goals as CSV" }).isVisible()));
    await tab.keyboard.press("Enter");
    await press(tab, ["Tab", "Tab", "Tab"]);
    const [download] = await Promise.all([tab.waitForEvent("download"), tab.keyboard.press("Enter")]);
    assert.equal(download.suggestedFilename(), "paper-d0-goals.csv");
    assert.equal(await tab.locator(".play").innerText(), "▶", "the space bar opened the menu and did not play");
  });

  await proves("a page with the derived parts inside tells ways and prices without a server", async (at) => {
    const [family, prices] = [await ask(one, "family/1"), await ask(one, "prices/1")];
    const block = { a: { families: { 1: family }, prices: { 1: prices } } };
    const file = join(mkdtempSync(join(tmpdir(), "wisdom-viewer-")), "report.html");
    writeFileSync(file, inlined(sample, "paper.mcap", block));
    const { tab, asked } = await at(`${pathToFileURL(file).href}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    await tab.keyboard.press("w");
    await legend(tab, "alternative");
    assert.doesNotMatch(await tab.locator(".legend").innerText(), /not in the log/);
    await tab.locator("tr.goal.deferred").first().click();
    await tab.waitForSelector(".prices");
    assert.deepEqual(asked.filter((url) => /^https?:/.test(url)), []);
  });

  await proves("a page without derived layers says where they can be had", async (at) => {
    const file = join(mkdtempSync(join(tmpdir(), "wisdom-viewer-")), "report.html");
    writeFileSync(file, inlined(sample, "paper.mcap"));
    const { tab } = await at(`${pathToFileURL(file).href}#d=1`);
    await ready(tab);
    await tab.waitForFunction(() => document.querySelector(".derived-note").textContent.startsWith("derived layers: wisdom view LOG; "));
    assert.equal(await tab.locator('optgroup[label="credits"]').count(), 0);
    await tab.keyboard.press("w");
    await legend(tab, "ways of alternatives are not in the log");
    await tab.locator("tr.goal.deferred").first().click();
    assert.match(await tab.locator(".price-tag").innerText(), /wisdom view LOG.*wisdom report LOG --html FILE .*--prices/);
    await shoot(tab, "alone");
  });
};
