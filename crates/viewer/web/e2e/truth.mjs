// What the page says held against what our own reader says of the same log: `wisdom log cat`, `explain`, `compare`, and the planes that
// the core makes again.

import assert from "node:assert/strict";
import { mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { page, ready } from "./house.mjs";
import { asked, decision, report } from "./rust.mjs";

/** Viridis as matplotlib has it (Smith and van der Walt 2015), at tenths. */
const VIRIDIS = ["440154", "482475", "414487", "355f8d", "2a788e", "21918c", "22a884", "44bf70", "7ad151", "bddf26", "fde725"].map((code) => [0, 2, 4].map((i) => Number.parseInt(code.slice(i, i + 2), 16)));
const viridis = (value) => {
  const place = Math.min(9.999, Math.max(0, value * 10));
  const [low, high] = [VIRIDIS[Math.floor(place)], VIRIDIS[Math.floor(place) + 1]];
  return low.map((from, i) => from + (high[i] - from) * (place % 1));
};
const apart = (one, other) => Math.max(...one.map((value, i) => Math.abs(value - other[i])));

/** Moves the pointer over places of the map; what is there: the cell, as the page tells it, and the colour drawn. */
const sampled = async (tab, count) => {
  const box = await tab.locator("canvas.map").boundingBox();
  const found = [];
  for (let i = 0; i < count; i++) {
    // Spread by the golden ratio, away from what lies over the map's edges.
    const [x, y] = [box.x + box.width * (0.36 + 0.55 * ((i * 0.618034) % 1)), box.y + box.height * (0.08 + 0.84 * ((i + 0.5) / count))];
    await tab.mouse.move(x, y);
    await tab.waitForTimeout(30);
    const told = await tab.evaluate(
      ([x, y]) => {
        const canvas = document.querySelector("canvas.map");
        const { left, top, width } = canvas.getBoundingClientRect();
        const scale = canvas.width / width;
        const cell = /cell \((\d+), (\d+)\)/.exec(document.querySelector(".readout").textContent ?? "");
        return cell && { cell: { row: Number(cell[1]), col: Number(cell[2]) }, x: Math.round((x - left) * scale), y: Math.round((y - top) * scale) };
      },
      [x, y],
    );
    if (told) found.push(told);
  }
  // Away from the map, so that nothing of the pointer's is drawn.
  await tab.mouse.move(box.x + box.width + 200, box.y + 5);
  await tab.waitForTimeout(150);
  const colours = await tab.evaluate((places) => {
    const context = document.querySelector("canvas.map").getContext("2d");
    return places.map(({ x, y }) => [...context.getImageData(x, y, 1, 1).data.slice(0, 3)]);
  }, found);
  return found.map((one, i) => ({ ...one, colour: colours[i] }));
};

export const truth = async ({ proves, shoot, drawn, one, two, rust, samples }) => {
  const [log, logB] = samples;

  await proves("the command hands out the page that was built", async () => {
    const served = await (await fetch(one)).text();
    assert.ok(served.replace(/<script type="application\/json" id="served">.*?<\/script>\n/, "") === page.toString(), "build the command anew: it has another page inside");
  });

  await proves("every goal's numbers, verdict and reason are those of the record", async (at) => {
    for (const number of [0, 2, 4]) {
      const { choice } = decision(log, number);
      const { tab } = await at(`${one}#d=${number}`);
      await ready(tab);
      await drawn(tab, number);
      const rows = await tab.locator(".goal-table tr.goal").evaluateAll((found) => found.map((row) => [Number(row.dataset.goal), row.innerText.replace(/\s+/g, " ")]));
      assert.equal(rows.length, choice.verdicts.length);
      const told = new Map(rows);
      for (const { goal, action, reason } of choice.verdicts) {
        const text = told.get(goal.id);
        for (const part of [`G${goal.id}`, goal.directive_name, goal.interest.toFixed(3), goal.prize.toFixed(3), action, reason]) {
          assert.ok(text?.includes(part), `decision ${number}, G${goal.id}: no ${part} in “${text}”`);
        }
      }
    }
  });

  await proves("the chosen plan and the family are those of the record", async (at) => {
    const { objective, choice } = decision(log, 1);
    const { tab } = await at(`${one}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    const { sequence } = objective.family[choice.chosen];
    const head = await tab.locator("aside").innerText();
    for (const part of [sequence.reliability.toFixed(4), `${(sequence.energy_j / 1e3).toFixed(1)} kJ`, `${sequence.data_mb.toFixed(0)} MB`]) {
      assert.ok(head.includes(part), `no ${part} in “${head.slice(0, 400)}”`);
    }
    await tab.locator("#tab-plans").click();
    await tab.waitForSelector("tr[data-option]");
    const rows = await tab.locator("tr[data-option]").evaluateAll((found) => found.map((row) => [Number(row.dataset.option), row.innerText.replace(/\s+/g, " ")]));
    assert.equal(rows.length, objective.family.length);
    for (const [option, text] of rows) {
      const { sequence } = objective.family[option];
      for (const part of [...sequence.stops.map(({ goal }) => `G${goal}`), sequence.reliability.toFixed(4)]) assert.ok(text.includes(part), `plan ${option}: no ${part} in “${text}”`);
    }
  });

  await proves("the colours on the map are those of the values our reader finds there", async (at) => {
    for (const [number, name] of [[0, "interest"], [4, "interest"], [4, "ignorance"]]) {
      const { tab } = await at(`${one}#d=${number}`);
      await ready(tab);
      await drawn(tab, number);
      if (name !== "interest") {
        await tab.locator('select[aria-label="Layer"]').selectOption(`derived:${name}`);
        await tab.waitForFunction((words) => document.querySelector(".legend").textContent.includes(words), name);
      }
      // Without relief, the colour is the layer's alone.
      if (!(await tab.locator(".legend").innerText()).includes("no relief")) await tab.keyboard.press("s");
      await tab.waitForTimeout(250);
      const plane = await rust.plane(number, name);
      const found = await sampled(tab, 90);
      assert.ok(found.length > 45, `${found.length} places on the map`);
      const wrong = found.filter(({ cell, colour }) => apart(colour, viridis(plane.at(cell))) > 14);
      // Goals, ways and the rover lie over some cells.
      assert.ok(wrong.length <= found.length / 5, `${wrong.length} of ${found.length} cells of ${name} in decision ${number}, such as ${JSON.stringify(wrong.slice(0, 3))}`);
      const seen = new Set(found.map(({ cell }) => plane.at(cell).toFixed(2)));
      assert.ok(seen.size > 10, `only ${[...seen]} was seen`);
    }
  });

  await proves("a report from disk tells the credits that it was given, without a server", async (at) => {
    const folder = mkdtempSync(join(tmpdir(), "wisdom-"));
    const html = join(folder, "report.html");
    report(log, "--html", html, "--planes", "all", "--families", "--prices", "1");
    const { tab, asked: requests } = await at(`${pathToFileURL(html).href}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    await tab.keyboard.press("m");
    await tab.keyboard.press("Alt+ArrowDown");
    await tab.waitForSelector(".credit-at");
    await tab.waitForFunction(() => ![...document.querySelectorAll(".readout .v")].some((one) => one.textContent === "…"));
    const text = await tab.locator(".readout").innerText();
    const [, row, col] = /cell \((\d+), (\d+)\)/.exec(text).map(Number);
    const { experts } = await rust.cell(1, { row, col });
    const credits = await tab.locator(".credit-at").allInnerTexts();
    assert.deepEqual(credits.map(Number), experts.map(({ credit }) => Number(credit.toFixed(4))));
    assert.deepEqual(requests.filter((url) => !/^(file|blob|data):/.test(url)), []);
    await shoot(tab, "report");
  });

  await proves("two runs part where the command says they do", async (at) => {
    const { worlds } = asked("compare", log, logB);
    const number = worlds[0].runs[1].against_first.first_divergent_decision;
    assert.ok(Number.isInteger(number), `the command says where: ${number}`);
    const { tab } = await at(two);
    await ready(tab);
    await tab.waitForFunction(() => document.documentElement.dataset.other === "true");
    await tab.getByRole("button", { name: /First divergence/ }).click();
    await drawn(tab, number);
    await shoot(tab, "divergence");
  });
};
