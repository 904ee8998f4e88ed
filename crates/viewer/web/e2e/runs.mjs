// Two runs, the timeline, what is saved and printed, and links to a moment; held against the logs.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

import { ready } from "./house.mjs";

const both = (tab) => tab.waitForFunction(() => document.documentElement.dataset.other === "true");
const title = (tab) => tab.locator("aside .title h2").innerText();
const titled = (tab, words) => tab.waitForFunction((text) => document.querySelector("aside .title h2")?.textContent === text, words);
const press = async (tab, ...keys) => {
  for (const key of keys) await tab.keyboard.press(key);
};
const saved = async (tab, act) => {
  const [download] = await Promise.all([tab.waitForEvent("download"), act()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
};
const button = (tab, name) => tab.getByRole("button", { name, exact: true });

/** Rows of a CSV file as RFC 4180 has them. */
const rowsOf = (bytes) => {
  const text = bytes.toString("utf8");
  assert.ok(text.endsWith("\r\n"), "the last line ends");
  const rows = [[]];
  for (let i = 0; i < text.length; ) {
    const row = rows.at(-1);
    let field = "";
    if (text[i] === '"') {
      for (i += 1; text[i] !== '"' || text[i + 1] === '"'; i++) {
        if (text[i] === '"') i += 1;
        field += text[i];
      }
      i += 1;
    } else for (; text[i] !== "," && text[i] !== "\r"; i++) field += text[i];
    row.push(field);
    if (text[i] === ",") i += 1;
    else {
      assert.equal(text.slice(i, i + 2), "\r\n");
      i += 2;
      if (i < text.length) rows.push([]);
    }
  }
  return rows;
};
/** The same, as records by the names in the first row; every row as long as the first. */
const recordsOf = (bytes) => {
  const [head, ...rows] = rowsOf(bytes);
  for (const row of rows) assert.equal(row.length, head.length, row.join());
  return rows.map((row) => Object.fromEntries(row.map((field, i) => [head[i], field])));
};

export const runs = async ({ proves, shoot, drawn, one, two }) => {
  await proves("the first divergence is one key away, and told term by term", async (at) => {
    const { tab } = await at(two);
    await ready(tab);
    await both(tab);
    await press(tab, "f");
    await titled(tab, "Decision 1 of 0 … 4");
    await drawn(tab, 1);
    const terms = tab.locator(".terms");
    assert.equal(await terms.locator("tr.first").count(), 1);
    assert.match(await terms.locator("tr.first").innerText(), /differs first/);
    const { name, bytes } = await saved(tab, () => button(tab, "Save all terms as CSV").click());
    assert.equal(name, "paper-d1-divergence-against-d1.csv");
    const all = recordsOf(bytes);
    const differing = all.filter(({ differs }) => differs === "yes");
    assert.ok(differing.length > 0 && differing.length < all.length);
    for (const { a, b, b_less_a } of all.filter(({ b_less_a }) => b_less_a !== "")) assert.equal(Number(b_less_a), Number(b) - Number(a));
    // What differs first in the order of the decision is what is marked.
    const marked = await terms.locator("tr.first th").evaluate((th) => th.firstChild.textContent);
    assert.equal(marked, differing[0].term);
    await tab.locator(".terms").scrollIntoViewIfNeeded();
    await shoot(tab, "terms");
    // What is equal is folded away with its count, and unfolds by key.
    const fold = terms.getByRole("button", { name: /\d+ equal/ }).first();
    const count = Number(/(\d+) equal/.exec(await fold.innerText())[1]);
    assert.equal(await terms.locator("tr.equal").count(), 0);
    await fold.focus();
    await tab.keyboard.press("Enter");
    assert.equal(await terms.locator("tr.equal").count(), count);
    assert.equal(await tab.evaluate(() => document.activeElement.getAttribute("aria-expanded")), "true");
  });

  await proves("the facts that the runs differ in are told, the equal ones on request", async (at) => {
    const { tab } = await at(two);
    await ready(tab);
    await both(tab);
    // What can be derived of the second run comes a little later, and the page is made anew with it.
    await tab.waitForTimeout(300);
    const { bytes } = await saved(tab, () => button(tab, "Save the runs' facts as CSV").click());
    const facts = recordsOf(bytes);
    const differ = facts.filter(({ key, differs }) => differs === "yes" && !key.endsWith("digest")).map(({ key }) => key.replaceAll("_", " "));
    assert.ok(differ.includes("decision version"));
    const shown = () => tab.locator(".page-other .sides").first().locator("tbody th").allInnerTexts();
    assert.deepEqual(await shown(), differ);
    await tab.getByRole("button", { name: /facts are equal/ }).click();
    assert.equal((await shown()).length, facts.length);
  });

  await proves("either run leads: the panel, its tabs, steps and the link are then of that run", async (at) => {
    const { tab } = await at(`${two}#d=1`);
    await ready(tab);
    await both(tab);
    await drawn(tab, 1);
    const told = () => tab.locator('.subject [aria-pressed="true"]').innerText();
    const goals = () => tab.locator(".goal-table tr.goal .name").allInnerTexts();
    assert.match(await told(), /^A /);
    await press(tab, "1");
    await tab.waitForSelector(".goal-table tr.goal");
    const ofA = await goals();
    await press(tab, "x");
    await tab.waitForFunction(() => /&run=b$/.test(location.hash));
    assert.match(await told(), /^B /);
    assert.notDeepEqual(await goals(), ofA);
    await press(tab, "End");
    // Its own last decision.
    await tab.waitForFunction(() => /^Decision (\d+) of 0 … \1$/.test(document.querySelector("aside .title h2").textContent));
    const last = await title(tab);
    await shoot(tab, "of-b");
    const link = await tab.evaluate(() => location.href);
    const { tab: again } = await at(link);
    await ready(again);
    await both(again);
    await titled(again, last);
    assert.match(await again.locator('.subject [aria-pressed="true"]').innerText(), /^B /);
    // A mere change of who leads moves neither run.
    for (const key of ["x", "x", "x", "x"]) await press(tab, key);
    await titled(tab, last);
  });

  await proves("a decision of B in the timeline, or a goal of B in its lanes, turns the panel to B", async (at) => {
    const { tab } = await at(`${two}#d=0&tab=goals`);
    await ready(tab);
    await both(tab);
    await press(tab, "t");
    const box = await tab.locator("canvas.lanes").boundingBox();
    await tab.mouse.click(box.x + box.width - 140, box.y + 69);
    await tab.waitForFunction(() => document.querySelector('.subject [aria-pressed="true"]').textContent.startsWith("B"));
    const [, number, to] = /^Decision (\d+) of 0 … (\d+)$/.exec(await title(tab));
    assert.ok(Number(number) > 0 && Number(number) <= Number(to));
    await tab.mouse.click(box.x + box.width - 140, box.y + 33);
    await tab.waitForFunction(() => document.querySelector('.subject [aria-pressed="true"]').textContent.startsWith("A"));
  });

  await proves("plans of one order are folded, and told as differences to the chosen on request", async (at) => {
    const { tab } = await at(`${one}#d=1&tab=plans`);
    await ready(tab);
    await drawn(tab, 1);
    const all = Number(await tab.locator("#tab-plans .count").innerText());
    const inSight = () => tab.locator(".plan-table tbody tr:visible").count();
    const orders = await tab.locator(".plan-table td.order").evaluateAll((cells) => new Set(cells.map((cell) => /G\d+( › G\d+)*/.exec(cell.textContent)?.[0])).size);
    assert.ok((await inSight()) >= orders && (await inSight()) <= orders + 1, "one of each order, and the best found beside the one chosen");
    for (const fold of await tab.locator(".plan-table .fold").all()) await fold.press("Enter");
    assert.equal(await inSight(), all);
    await button(tab, "differences to the chosen").click();
    const cells = await tab.locator(".plan-table tbody tr:not(.chosen) td.number").allInnerTexts();
    for (const cell of cells) assert.match(cell, /^(=|[+−]\d.*)$/);
  });

  await proves("a row that has the focus says what its codes mean, and an opened goal what its prize is made of", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    await press(tab, "g", "ArrowDown");
    const said = tab.locator(".goal-table tr:focus .saying");
    assert.match(await said.innerText(), /^It .+\./);
    await press(tab, "Enter");
    await tab.waitForSelector("tr.detail");
    assert.match(await tab.locator("tr.detail").innerText(), /prize [\d.]+ = weight [\d.]+ of .+ × unweighted prize [\d.]+/);
  });

  await proves("two runs are shown by a wipe, side by side under one hand, or as a difference", async (at) => {
    const { tab } = await at(`${two}#d=1`);
    await ready(tab);
    await both(tab);
    const on = () => tab.locator('.modes [aria-pressed="true"]').innerText();
    assert.equal(await on(), "wipe");
    await press(tab, "b");
    await tab.waitForFunction(() => document.querySelector('.modes [aria-pressed="true"]').textContent === "side by side");
    const box = await tab.locator("canvas.map").boundingBox();
    // Nearer and moved, both halves still show the same ground.
    await tab.mouse.move(box.x + box.width * 0.25, box.y + box.height * 0.5);
    await tab.mouse.wheel(0, -300);
    await tab.mouse.down();
    await tab.mouse.move(box.x + box.width * 0.3, box.y + box.height * 0.6, { steps: 4 });
    await tab.mouse.up();
    const cell = async (part) => {
      await tab.mouse.move(box.x + box.width * part, box.y + box.height * 0.5);
      await tab.waitForTimeout(250);
      return /cell (\(.*?\))/.exec(await tab.locator(".readout").innerText())[1];
    };
    assert.equal(await cell(0.3), await cell(0.8));
    await shoot(tab, "side-by-side");
    await button(tab, "A less B").click();
    await tab.waitForFunction(() => document.querySelector(".legend").textContent.includes("A less B"));
    assert.equal(await on(), "A less B");
  });

  await proves("the timeline has the lanes of both runs, goals of one place in one lane", async (at) => {
    const { tab } = await at(two);
    await ready(tab);
    await both(tab);
    await tab.waitForTimeout(300);
    const { name, bytes } = await saved(tab, () => button(tab, "Save the timeline as SVG").click());
    assert.equal(name, "paper-timeline.svg");
    const texts = [...bytes.toString().matchAll(/<text[^>]*>([^<]*)<\/text>/g)].map(([, text]) => text);
    for (const words of ["decisions A", "events A", "decisions B", "events B", "next", "in the plan", "deferred", "done", "dropped"]) assert.ok(texts.includes(words), words);
    const lanes = texts.filter((text) => /^(A G\d+|B G\d+|A G\d+ · B G\d+)$/.test(text));
    assert.ok(lanes.some((lane) => lane.includes(" · ")), "some goals are of one place");
    for (const side of ["A", "B"]) {
      const named = lanes.flatMap((lane) => lane.split(" · ")).filter((goal) => goal.startsWith(side));
      assert.ok(named.length > 0, side);
      assert.equal(new Set(named).size, named.length, "no goal has two lanes");
    }
  });

  await proves("the timeline is scrubbed by dragging, and tells what lies under the pointer", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    const box = await tab.locator("canvas.lanes").boundingBox();
    const [left, right] = [box.x + 90, box.x + box.width - 120];
    await tab.mouse.move(left, box.y + 33);
    await tab.mouse.down();
    await tab.mouse.move(right, box.y + 33, { steps: 8 });
    await titled(tab, "Decision 4 of 0 … 4");
    await tab.mouse.move(left, box.y + 33, { steps: 8 });
    await titled(tab, "Decision 0 of 0 … 4");
    await tab.mouse.up();
    await tab.mouse.move(left + 30, box.y + 71);
    await tab.waitForFunction(() => /^decision 0, 0:00 h · G\d+ .+: (next|in the plan|deferred)/.test(document.querySelector(".hint").textContent));
    await shoot(tab, "timeline-hint");
  });

  await proves("playing keeps the pace asked for, stops at the end, or begins anew", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    const pace = (value) => tab.waitForFunction((text) => document.querySelector("select.pace").value === text, value);
    await press(tab, ".", ".", ".");
    await pace("16");
    await press(tab, ",");
    await pace("8");
    const start = Date.now();
    await press(tab, "Space");
    await titled(tab, "Decision 4 of 0 … 4");
    assert.ok(Date.now() - start >= 400, "four steps at eight a second");
    await tab.waitForFunction(() => document.querySelector(".play").getAttribute("aria-label") === "Play");
    await press(tab, "r", "Space");
    // It began anew once by being started at the end, and does so again by itself.
    for (const words of ["Decision 0 of 0 … 4", "Decision 4 of 0 … 4", "Decision 0 of 0 … 4"]) await titled(tab, words);
    await press(tab, "Space");
  });

  await proves("every table is saved as CSV, with the log's own numbers", async (at) => {
    const { tab } = await at(`${one}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    const count = async (name) => Number(await tab.locator(`#tab-${name} .count`).innerText());
    const tables = [
      ["2", "Save the changes as CSV", "paper-d1-changes.csv", await count("changes")],
      ["3", "Save the plans as CSV", "paper-d1-plans.csv", await count("plans")],
      ["4", "Save all decisions as CSV", "paper-decisions.csv", 5],
      ["4", "Save the topics as CSV", "paper-topics.csv", undefined],
      ["4", "Save the run's facts as CSV", "paper-run.csv", undefined],
      ["4", "Save all that was written as CSV", "paper-written.csv", undefined],
    ];
    for (const [key, label, file, rows] of tables) {
      await press(tab, key);
      const { name, bytes } = await saved(tab, () => button(tab, label).click());
      assert.equal(name, file);
      const records = recordsOf(bytes);
      assert.ok(records.length > 0, file);
      if (rows !== undefined) assert.equal(records.length, rows, file);
    }
  });

  await proves("every figure is saved as SVG, which stands alone, and as PNG", async (at) => {
    const { tab } = await at(`${one}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    for (const [key, what, file] of [["1", "the timeline", "paper-timeline"], ["3", "the plot", "paper-d1-plans"], ["4", "the trends", "paper-trends"]]) {
      await press(tab, key);
      const svg = await saved(tab, () => button(tab, `Save ${what} as SVG`).click());
      assert.equal(svg.name, `${file}.svg`);
      const sound = await tab.evaluate((text) => new DOMParser().parseFromString(text, "image/svg+xml").querySelector("parsererror") === null, svg.bytes.toString());
      assert.ok(sound, `${file}.svg can be read`);
      assert.doesNotMatch(svg.bytes.toString(), /var\(--|href=|url\((?!#)/, `${file}.svg needs nothing from elsewhere`);
      const png = await saved(tab, () => button(tab, `Save ${what} as PNG`).click());
      assert.equal(png.name, `${file}.png`);
      assert.equal(png.bytes.subarray(1, 4).toString(), "PNG");
      assert.ok(png.bytes.readUInt32BE(16) >= 800, "twice as fine as it is wide");
    }
  });

  await proves("the plan family can be seen by any two of its numbers, the choice marked by its shape", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    await press(tab, "3");
    const family = tab.locator(".page-plans svg.family");
    assert.match(await family.innerHTML(), /interest \(sum of prizes\)/);
    assert.equal(await family.locator(".plan.chosen").count(), 1);
    assert.doesNotMatch(await family.locator(".plan.chosen").getAttribute("d"), /A/, "corners, where others are round");
    await tab.getByLabel("Up: measure of the plot").selectOption("energyJ");
    assert.match(await family.innerHTML(), /energy, MJ/);
    assert.equal(String(await family.locator(".plan").count()), await tab.locator("#tab-plans .count").innerText());
  });

  await proves("a link holds all that is looked at, and can be copied", async (at) => {
    const { tab } = await at(`${two}#d=2&goal=8&tab=plans&axis=decision&split=halves&layer=read:temperature&cell=40,50`, { permissions: ["clipboard-read", "clipboard-write"] });
    await ready(tab);
    await both(tab);
    await drawn(tab, 2);
    await tab.waitForFunction(() => document.querySelector('.modes [aria-pressed="true"]')?.textContent === "side by side");
    assert.equal(await title(tab), "Decision 2 of 0 … 4");
    assert.equal(await tab.locator('.tabs [aria-selected="true"]').evaluate((tab) => tab.id), "tab-plans");
    assert.equal(await tab.locator('select[aria-label="Layer"]').inputValue(), "read:temperature");
    assert.match(await tab.locator(".readout").innerText(), /cell \(40, 50\)/);
    assert.equal(await tab.locator(".sequence .picked").innerText(), "G8");
    await press(tab, "y");
    await tab.waitForSelector(".toast:not([hidden])");
    const link = await tab.evaluate(() => navigator.clipboard.readText());
    const { tab: again } = await at(link);
    await ready(again);
    await both(again);
    await drawn(again, 2);
    await again.waitForFunction(() => /cell \(40, 50\)/.test(document.querySelector(".readout").textContent));
    assert.equal(new URL(again.url()).hash, new URL(link).hash);
  });

  await proves("the way back leads over what was chosen, not over every step", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    await tab.waitForFunction(() => location.hash === "#d=0");
    const length = () => tab.evaluate(() => history.length);
    const before = await length();
    for (let i = 0; i < 4; i++) {
      await press(tab, "ArrowRight");
      await tab.waitForTimeout(200);
    }
    await tab.waitForFunction(() => location.hash === "#d=4");
    assert.equal(await length(), before);
    await press(tab, "3");
    await tab.waitForFunction(() => location.hash === "#d=4&tab=plans");
    await tab.waitForTimeout(200);
    await press(tab, "2");
    await tab.waitForFunction(() => location.hash === "#d=4&tab=changes");
    await tab.goBack();
    await tab.waitForFunction(() => document.querySelector('.tabs [aria-selected="true"]').id === "tab-plans");
    await tab.goBack();
    await tab.waitForFunction(() => document.querySelector('.tabs [aria-selected="true"]').id === "tab-goals");
    await tab.goForward();
    await tab.waitForFunction(() => document.querySelector('.tabs [aria-selected="true"]').id === "tab-plans");
    assert.equal(await title(tab), "Decision 4 of 0 … 4");
  });

  await proves("on paper stand map, decision, all pages and the timeline, one after another", async (at) => {
    const { tab } = await at(`${two}#d=1`, { colorScheme: "dark" });
    await ready(tab);
    await both(tab);
    await drawn(tab, 1);
    const pdf = await tab.pdf({ preferCSSPageSize: true });
    assert.equal(pdf.subarray(0, 5).toString(), "%PDF-");
    assert.equal(await tab.locator(".paper").count(), 0, "nothing of it stays behind");
    await tab.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    const paper = await tab.evaluate(() => ({
      heads: [...document.querySelectorAll(".paper > section > h2")].map((one) => one.textContent),
      goals: document.querySelectorAll(".paper tr.goal").length,
      figures: document.querySelectorAll(".paper svg[role=img], .paper-map > svg").length,
      twice: [...document.querySelectorAll("[id]")].filter((one, _, all) => all.filter(({ id }) => id === one.id).length > 1 && !one.closest("svg")).length,
      ink: getComputedStyle(document.querySelector(".paper")).color,
    }));
    assert.deepEqual(paper.heads, ["Goals", "Changes", "Plans", "Run", "A and B", "Timeline", "Topics in the file"]);
    assert.equal(String(paper.goals), await tab.locator("#tab-goals .count").innerText());
    assert.ok(paper.figures >= 4, `${paper.figures} figures`);
    assert.equal(paper.twice, 0);
    await tab.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    assert.equal(await tab.evaluate(() => document.documentElement.dataset.theme), undefined);
  });
};
