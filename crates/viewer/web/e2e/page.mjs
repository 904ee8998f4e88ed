// The page's own parts, where they stand and what they say: legend, values of a cell, timeline, paper, theme.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

import { inlined, ready } from "./house.mjs";
import { decision } from "./rust.mjs";

const both = (tab) => tab.waitForFunction(() => document.documentElement.dataset.other === "true");
const titled = (tab, words) => tab.waitForFunction((text) => document.querySelector("aside .title h2")?.textContent === text, words);
const box = (tab, of) => tab.locator(of).boundingBox();
const savedMap = async (tab) => {
  await tab.locator(".menu summary").click();
  const [download] = await Promise.all([tab.waitForEvent("download"), tab.getByRole("button", { name: "Map as SVG" }).click()]);
  return readFileSync(await download.path(), "utf8");
};
/** Whether two boxes share ground. */
const overlap = (a, b) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

export const page = async ({ proves, shoot, drawn, server, one, two, sample, log }) => {
  await proves("on paper the map is whole, whatever the window, and the table of topics comes last", async (at) => {
    for (const height of [560, 768, 1100]) {
      const { tab } = await at(`${one}#d=1`, { viewport: { width: 1366, height } });
      await ready(tab);
      await drawn(tab, 1);
      // Nearer and farther again: the same ground is in sight, but it no longer follows the size of the window.
      await tab.locator("canvas.map").focus();
      for (const key of ["+", "-"]) await tab.keyboard.press(key);
      await tab.waitForTimeout(200);
      await tab.emulateMedia({ media: "print" });
      await tab.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
      const { clip, ground, ratio, shown, last } = await tab.evaluate(() => {
        const svg = document.querySelector(".paper-map > svg");
        const sides = (rect) => Object.fromEntries(["x", "y", "width", "height"].map((name) => [name, Number(rect.getAttribute(name))]));
        const { width, height } = svg.getBoundingClientRect();
        return {
          clip: sides(svg.querySelector("clipPath rect")),
          ground: sides(svg.querySelector("[clip-path] rect")),
          ratio: svg.viewBox.baseVal.width / svg.viewBox.baseVal.height,
          shown: width / height,
          last: [...document.querySelectorAll(".paper > section > h2")].at(-1).textContent,
        };
      });
      // The sample's ground is as wide as it is long.
      assert.ok(Math.abs(ground.width / ground.height - 1) < 0.01, `the ground is ${ground.width} by ${ground.height}`);
      assert.ok(clip.x <= ground.x && clip.y <= ground.y && clip.x + clip.width >= ground.x + ground.width && clip.y + clip.height >= ground.y + ground.height, `at ${height}: ${JSON.stringify({ clip, ground })}`);
      assert.ok(Math.abs(ratio / shown - 1) < 0.01, `drawn ${ratio}, shown ${shown}`);
      assert.equal(last, "Topics in the file");
      await tab.evaluate(() => window.dispatchEvent(new Event("afterprint")));
    }
  });

  await proves("the legend, saved too, has the marks of goals and says what joins a way's end to its goal", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    const told = (await tab.locator(".legend .ways span").allInnerTexts()).map((words) => words.trim());
    const states = await tab.locator(".chip").allInnerTexts();
    for (const words of ["next leg", "plan", "pose to goal", ...states.map((state) => state.replace(/ \d+$/, ""))]) assert.ok(told.includes(words), `${words} among ${told}`);
    const svg = await savedMap(tab);
    const texts = [...svg.matchAll(/<text[^>]*>([^<]*)<\/text>/g)].map(([, text]) => text);
    for (const words of told) assert.ok(texts.includes(words), `${words} in the saved map`);
    assert.match(svg, /class="pose-to-goal"/);
  });

  await proves("values of a cell cover neither map nor legend, of one run and of two", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    const ask = async (of, share) => {
      const map = await box(of, "canvas.map");
      await of.mouse.move(map.x + map.width * share, map.y + map.height / 2);
      await of.waitForFunction(() => document.querySelectorAll(".readout .v").length > 3 && ![...document.querySelectorAll(".readout .v")].some((one) => one.textContent === "…"));
    };
    await ask(tab, 0.6);
    assert.ok(!overlap(await box(tab, ".readout"), await box(tab, ".legend")), "one run");
    const { tab: second } = await at(two);
    await ready(second);
    await both(second);
    for (const mode of ["wipe", "side by side"]) {
      await second.getByRole("button", { name: mode, exact: true }).click();
      for (const share of [0.4, 0.8]) {
        await ask(second, share);
        const [readout, map] = [await box(second, ".readout"), await box(second, "canvas.map")];
        assert.ok(!overlap(readout, map), `${mode}, ${share}`);
      }
      assert.ok(!overlap(await box(second, ".legend"), await box(second, ".zoom-tools")), `${mode}: legend and buttons`);
      await shoot(second, `cell-${mode.replaceAll(" ", "-")}`);
    }
  });

  await proves("the wipe begins where it hides neither rover nor next goal", async (at) => {
    const { tab } = await at(two);
    await ready(tab);
    await both(tab);
    await tab.waitForTimeout(400);
    const svg = await savedMap(tab);
    const line = Number(/<line x1="([\d.]+)" x2="\1"/.exec(svg)[1]);
    const places = [...svg.matchAll(/<path[^>]*transform="translate\(([\d.-]+) [\d.-]+\) rotate[^>]*>|<g transform="translate\(([\d.-]+) [\d.-]+\)" class="goal next"/g)].map(([, rover, goal]) => Number(rover ?? goal));
    assert.ok(places.length >= 2, "rovers and goals are found");
    for (const x of places) assert.ok(Math.abs(x - line) > 20, `something to see at ${x}, the line at ${line}`);
  });

  await proves("the timeline is made higher by dragging its edge, and by key; twice clicked it is as at first", async (at) => {
    const { tab } = await at(one);
    await ready(tab);
    const height = async () => (await box(tab, ".time-pane")).height;
    const first = await height();
    const grip = await box(tab, ".time-grip");
    await tab.mouse.move(grip.x + grip.width / 2, grip.y + 4);
    await tab.mouse.down();
    await tab.mouse.move(grip.x + grip.width / 2, grip.y - 96, { steps: 4 });
    await tab.mouse.up();
    const dragged = await height();
    assert.ok(Math.abs(dragged - first - 100) < 8, `from ${first} to ${dragged}`);
    await tab.locator(".time-grip").focus();
    await tab.keyboard.press("ArrowDown");
    assert.ok((await height()) < dragged);
    for (let i = 0; i < 40; i++) await tab.keyboard.press("ArrowUp");
    assert.ok((await box(tab, ".map-pane")).height > 150, "the map keeps its room");
    await tab.locator(".time-grip").dblclick();
    assert.equal(await height(), first);
  });

  await proves("the first press of d shows the opposite of what is seen", async (at) => {
    for (const [colorScheme, first] of [["light", "dark"], ["dark", "light"]]) {
      const { tab } = await at(one, { colorScheme });
      await ready(tab);
      const light = () => tab.evaluate(() => getComputedStyle(document.querySelector("aside")).backgroundColor);
      const before = await light();
      await tab.keyboard.press("d");
      await tab.waitForFunction((theme) => document.documentElement.dataset.theme === theme, first);
      assert.notEqual(await light(), before);
    }
  });

  await proves("Enter in the filter opens the first goal that fits", async (at) => {
    const { tab } = await at(`${one}#d=1`);
    await ready(tab);
    await drawn(tab, 1);
    const named = await tab.locator(".goal-table tr.goal .name").nth(2).innerText();
    await tab.keyboard.press("/");
    await tab.waitForFunction(() => document.activeElement.matches(".goals input"));
    await tab.keyboard.type(named);
    const first = await tab.locator(".goal-table tr.goal .name").first().innerText();
    await tab.keyboard.press("Enter");
    await tab.waitForSelector(".goal-table tr.picked + .detail");
    assert.equal(await tab.locator(".goal-table tr.picked .name").innerText(), first);
  });

  await proves("n leads to the next decision at which the log adds or drops a goal, N back", async (at) => {
    const turning = [0, 1, 2, 3, 4].filter((number) => JSON.stringify(decision(log, number)).match(/"action":"(add|drop)"/));
    const { tab } = await at(`${one}#d=0`);
    await ready(tab);
    const after = turning.filter((number) => number > 0);
    assert.ok(after.length > 0, "the sample has such a decision");
    for (const number of after) {
      await tab.keyboard.press("n");
      await titled(tab, `Decision ${number} of 0 … 4`);
    }
    await tab.keyboard.press("n");
    await tab.waitForSelector(".toast:not([hidden])");
    for (const number of turning.slice(0, -1).reverse()) {
      await tab.keyboard.press("N");
      await titled(tab, `Decision ${number} of 0 … 4`);
    }
  });

  await proves("a page without derived layers says how its sender puts them in", async (at) => {
    const { tab } = await at("about:blank");
    await tab.route("http://page.test/", (route) => route.fulfill({ contentType: "text/html", body: inlined(sample, "paper.mcap") }));
    await tab.goto("http://page.test/");
    await ready(tab);
    assert.match(await tab.locator(".derived-note").innerText(), /wisdom report LOG --html FILE --planes all --families --prices all/);
  });

  await proves("of a log that was cut the timeline says where it ends, and the banner what to do", async (at) => {
    const { tab } = await at(server.url);
    await tab.waitForSelector(".welcome");
    await tab.locator('input[type="file"]').setInputFiles({ name: "cut.mcap", mimeType: "application/octet-stream", buffer: sample.subarray(0, Math.floor(sample.length * 0.7)) });
    await ready(tab);
    assert.match(await tab.locator(".banner").innerText(), /wisdom log recover LOG OUT\.$/);
    const [download] = await Promise.all([tab.waitForEvent("download"), tab.getByRole("button", { name: "Save the timeline as SVG", exact: true }).click()]);
    assert.match(readFileSync(await download.path(), "utf8"), /log cut here/);
    await shoot(tab, "cut-end");
  });
};
