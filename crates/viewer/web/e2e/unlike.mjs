// Two logs that are not of a kind: both cut, on different ground, one without what the other has; and planes that are slow to
// come, or came with the page.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { putTogether, takeApart } from "./forge.mjs";
import { inlined, ready } from "./house.mjs";
import { command, sample as samplePath } from "./rust.mjs";

const layer = (tab) => tab.locator('select[aria-label="Layer"]');
const legend = (tab, words) => tab.waitForFunction((text) => document.querySelector(".legend").textContent.includes(text), words);
const both = (tab) => tab.waitForFunction(() => document.documentElement.dataset.other === "true");
const ended = (tab) => tab.waitForFunction(() => document.documentElement.dataset.ready === "true");
/** As the page writes a number of unknown size below 100. */
const plain = (value) => (value === 0 ? "0" : value >= 1 ? value.toFixed(2) : value >= 1e-3 ? value.toFixed(4) : value.toExponential(1));
const folder = mkdtempSync(join(tmpdir(), "wisdom-unlike-"));
const kept = (name, bytes) => {
  writeFileSync(join(folder, name), bytes);
  return join(folder, name);
};
const give = (tab, ...files) => tab.locator('input[type="file"]').setInputFiles(files);
/** Opens a second log beside the first. */
const beside = async (tab, file) => {
  const [chooser] = await Promise.all([tab.waitForEvent("filechooser"), tab.getByRole("button", { name: "Compare…" }).click()]);
  await chooser.setFiles(file);
  await both(tab);
};
const cut = (bytes, share) => bytes.subarray(0, Math.floor(bytes.length * share));

export const unlike = async ({ proves, shoot, drawn, bare, one, two, sample, other }) => {
  await proves("a cell asked about before the second log was there is told of both as soon as it is", async (at) => {
    const { tab } = await at(`${one}#d=0&cell=60,60`);
    await ready(tab);
    await tab.waitForSelector(".readout .v");
    await beside(tab, other);
    await tab.waitForFunction(() => /A [\d.e-]+, B [\d.e-]+, A − B/.test(document.querySelector(".readout .both")?.textContent ?? ""));
    const before = await tab.locator(".readout .both").innerText();
    // Another log in its place is another run, at whatever decision.
    await beside(tab, samplePath(5));
    await tab.waitForFunction((was) => /A − B 0$/.test(document.querySelector(".readout .both")?.textContent ?? "") && document.querySelector(".readout .both").textContent !== was, before);
  });

  await proves("of two logs that are cut short each has its own line, and that of B goes with B", async (at) => {
    const { tab } = await at(bare);
    await give(tab, kept("a.mcap.part", cut(sample, 0.7)), kept("b.mcap.part", cut(sample, 0.9)));
    await ended(tab);
    await both(tab);
    const lines = tab.locator(".banner p");
    assert.deepEqual((await lines.allInnerTexts()).map((text) => text.slice(0, 23)), ["A: Cut short at byte " + (await lines.nth(0).innerText()).slice(21, 23), "B: Cut short at byte " + (await lines.nth(1).innerText()).slice(21, 23)]);
    await shoot(tab, "two-cut");
    await tab.keyboard.press("5");
    await tab.getByRole("button", { name: "Close B" }).click();
    await tab.waitForFunction(() => document.querySelectorAll(".banner p").length === 1);
    assert.match(await tab.locator(".banner").innerText(), /^Cut short at byte/);
  });

  await proves("runs on different ground stand side by side, each in sight as a whole, and no other way", async (at) => {
    const log = await takeApart(sample);
    const wider = log.metadata.map((one) => (one.name === "wisdom.run" ? { ...one, metadata: new Map([...one.metadata, ["grid_rows", String(3 * Number(one.metadata.get("grid_rows")))]]) } : one));
    const { tab } = await at(`${bare}#d=1&show=between`);
    await give(tab, samplePath(5), kept("other-ground.mcap", await putTogether({ ...log, metadata: wider })));
    await ready(tab);
    await both(tab);
    await drawn(tab, 1);
    await legend(tab, "other ground: no cell of A is one of B");
    assert.equal(await tab.locator(".map-pane").getAttribute("data-split"), "halves");
    for (const name of ["wipe", "A less B"]) assert.ok(await tab.locator(".modes").getByRole("button", { name }).isDisabled(), name);
    assert.equal(await tab.locator('option[value="between"]').count(), 0);
    await shoot(tab, "other-ground");
    const box = await tab.locator("canvas.map").boundingBox();
    const over = async (part) => {
      await tab.mouse.move(box.x + box.width * part, box.y + box.height * 0.5);
      await tab.waitForTimeout(250);
      return tab.locator(".readout").innerText();
    };
    const rows = Number(wider.find(({ name }) => name === "wisdom.run").metadata.get("grid_rows"));
    const [a, b] = [await over(0.25), await over(0.75)].map((text) => [text[0], Number(/cell \((\d+)/.exec(text)[1])]);
    assert.deepEqual([a[0], b[0]], ["A", "B"]);
    // In the middle of either half is the middle of its own ground.
    assert.ok(Math.abs(a[1] - rows / 6) < rows / 30 && Math.abs(b[1] - rows / 2) < rows / 10, `rows ${a[1]} and ${b[1]} of ${rows / 3} and ${rows}`);
    assert.equal(await tab.locator(".readout .both").count(), 0, "no cell is held against one of other ground");
    await tab.keyboard.press("v");
    await tab.waitForFunction(() => document.querySelector(".divide b:last-child").textContent === "B, other ground");
    await tab.waitForTimeout(400);
    await shoot(tab, "other-ground-solid");
  });

  await proves("a run that lacks the layer says so, and why", async (at) => {
    const { tab } = await at(`${two}#d=1`);
    await ready(tab);
    await both(tab);
    const { unavailable } = await (await fetch(new URL("b/derived/index", two))).json();
    assert.ok(unavailable, "of the older log nothing can be made again");
    await tab.waitForSelector('option[value="derived:ignorance"]', { state: "attached" });
    await layer(tab).selectOption("derived:ignorance");
    await legend(tab, `B: no such map: ${unavailable}`);
    assert.ok(await tab.locator(".legend .bar").isVisible(), "that of A is shown all the same");
    await shoot(tab, "b-lacks");
    await tab.keyboard.press("b");
    await tab.waitForFunction(() => document.querySelector(".map-pane").dataset.split === "halves");
    assert.ok(await tab.locator(".legend .caution").isVisible(), "side by side too");
    await shoot(tab, "b-lacks-halves");
    await tab.keyboard.press("5");
    await tab.waitForSelector(".page-other .sides");
  });

  await proves("what an older file does not tell is not said to be none", async (at) => {
    const { tab } = await at(bare);
    await give(tab, samplePath(5), fileOf("paper-0.1.0.mcap"));
    await both(tab);
    await tab.keyboard.press("5");
    await tab.waitForFunction(() => [...document.querySelectorAll(".page-other .sides td")].some((cell) => cell.textContent === "not told"));
  });

  await proves("of decisions stepped past nothing is asked, and goals never stand on another decision's layer unsaid", async (at) => {
    const { tab } = await at(`${one}#layer=derived:ignorance`);
    await ready(tab);
    await drawn(tab, 0);
    await legend(tab, "ignorance");
    const asked = [];
    await tab.route("**/derived/plane/**", async (route) => {
      asked.push(Number(/plane\/(\d+)\//.exec(route.request().url())[1]));
      await new Promise((resolve) => setTimeout(resolve, 700));
      await route.continue().catch(() => undefined);
    });
    const began = Date.now();
    for (let i = 0; i < 4; i++) {
      await tab.keyboard.press("ArrowRight");
      await tab.waitForTimeout(30);
    }
    await legend(tab, "being worked out");
    assert.equal(await tab.locator(".title h2").innerText(), "Decision 4 of 0 … 4");
    await shoot(tab, "stale");
    await drawn(tab, 4);
    const took = Date.now() - began;
    assert.deepEqual(asked, [1, 4]);
    assert.ok(took < 3500, `${took} ms`);
    assert.doesNotMatch(await tab.locator(".legend").innerText(), /being worked out|faded/);
  });

  await proves("planes that came with the page are offered as derived, beside the log as it was logged", async (at) => {
    const planes = ["ignorance", "elevation", "mass-interesting-dem", "mass-not-interesting-dem", "mass-ignorance-dem", "mass-paradox-dem", "credit-dem"];
    const expanded = join(folder, "planes.mcap");
    execFileSync(command, ["log", "expand", samplePath(5), expanded, "--maps", "patch", "--planes", planes.join(",")], { stdio: "ignore" });
    const served = await (await fetch(new URL("a/derived/index", one))).json();
    const index = { ...served, planes: served.planes.filter(({ name }) => planes.includes(name)) };
    const html = kept("planes.html", inlined(sample, "paper.mcap", { a: { index } }, readFileSync(expanded)));
    const { tab, asked } = await at(`${pathToFileURL(html).href}#d=3&cell=60,60`);
    await ready(tab);
    await drawn(tab, 3);
    const offered = await tab.locator('select[aria-label="Layer"] option').evaluateAll((all) => all.map(({ value }) => value));
    assert.deepEqual(offered.filter((id) => id.startsWith("derived:")).map((id) => id.slice(8)).sort(), [...planes].sort());
    assert.ok(offered.includes("map:elevation"), "the map that was logged is listed still");
    await layer(tab).selectOption("derived:ignorance");
    await legend(tab, index.planes.find(({ name }) => name === "ignorance").label);
    await tab.waitForSelector(".readout .credit-at");
    const { experts } = await (await fetch(new URL("a/derived/cell/3/60/60", one))).json();
    const { masses, credit } = experts.find(({ name }) => name === "dem");
    const told = (await tab.locator(".experts tbody tr").innerText()).split(/\s+/);
    assert.deepEqual(told, ["dem", ...[masses.interesting, masses.not_interesting, masses.ignorance, masses.paradox].map((mass) => mass.toFixed(3)), credit === null ? "none" : credit.toFixed(4)]);
    await tab.keyboard.press("4");
    assert.doesNotMatch(await tab.locator(".topics").innerText(), /\/map\/ignorance/, "topics are those of the log");
    assert.deepEqual(asked.filter((url) => /^https?:/.test(url)), []);
    await shoot(tab, "planes-inside");
  });

  await proves("a page of two logs has the planes of both", async (at) => {
    const planes = join(folder, "two-planes.mcap");
    execFileSync(command, ["log", "expand", samplePath(5), planes, "--maps", "patch", "--planes", "ignorance"], { stdio: "ignore" });
    const served = await (await fetch(new URL("a/derived/index", one))).json();
    const index = { ...served, planes: served.planes.filter(({ name }) => name === "ignorance") };
    const [bytes, log] = [readFileSync(planes), readFileSync(other)];
    const html = kept("two.html", inlined(log, "pcr6.mcap", { a: { index: { ...index, planes: [...index.planes, { ...index.planes[0], name: "conflict", label: "conflict" }] } }, b: { index } }, bytes, { log: sample, name: "paper.mcap", planes: bytes }));
    const { tab } = await at(`${pathToFileURL(html).href}#d=2&axis=decision&cell=60,60&layer=derived:ignorance`);
    await ready(tab);
    await both(tab);
    const { planes: at60 } = await (await fetch(new URL("a/derived/cell/2/60/60", one))).json();
    await tab.waitForFunction(() => /B \d/.test(document.querySelector(".readout .both")?.textContent ?? ""));
    assert.ok((await tab.locator(".readout .both").innerText()).includes(`B ${plain(at60.ignorance)}, A − B 0`), `${await tab.locator(".readout .both").innerText()} for ${at60.ignorance}`);
    // A plane that the index names and that is in neither is said to be in neither.
    await layer(tab).selectOption("derived:conflict");
    await legend(tab, "There is no such map at this decision.");
  });

  await proves("planes of a page that are damaged say so, and the log is shown", async (at) => {
    const served = await (await fetch(new URL("a/derived/index", one))).json();
    const html = kept("broken.html", inlined(sample, "paper.mcap", { a: { index: served } }, Buffer.from("no planes at all")));
    const { tab } = await at(`${pathToFileURL(html).href}#layer=derived:ignorance`);
    await ready(tab);
    await legend(tab, "This map cannot be had: the planes in this page: This is not an MCAP file");
    await layer(tab).selectOption("map:interest");
    await tab.waitForSelector(".legend .bar");
  });

  await proves("a page of a log that cannot be made again says why", async (at) => {
    const html = kept("old.html", inlined(readFileSync(samplePath(4)), "old.mcap", { a: { index: { unavailable: "decisions of version 4" } } }));
    const { tab } = await at(pathToFileURL(html).href);
    await ready(tab);
    await tab.waitForFunction(() => document.querySelector(".derived-note").textContent === "no derived layers: decisions of version 4");
  });

  await proves("a small window shows the whole ground beside its tools, and words within their panel", async (at) => {
    const { tab } = await at(`${one}#d=1`, { viewport: { width: 1024, height: 700 } });
    await ready(tab);
    await drawn(tab, 1);
    await shoot(tab, "small");
    const [tools, words] = [await tab.locator(".map-left").boundingBox(), await tab.locator(".legend").boundingBox()];
    const map = await tab.locator("canvas.map").boundingBox();
    const right = Math.max(tools.x + tools.width, words.x + words.width);
    await tab.mouse.move(right + 2, map.y + map.height / 2);
    await tab.waitForTimeout(150);
    assert.equal(await tab.locator(".readout").innerText(), "", "no ground lies under the tools");
    for (const key of ["1", "2", "3", "4"]) {
      await tab.keyboard.press(key);
      await tab.waitForTimeout(150);
      const wide = await tab.evaluate(() => [...document.querySelectorAll("aside, .pages, .page, .page table, .page thead th")].filter((one) => one.clientWidth > 0 && one.getBoundingClientRect().right > document.querySelector("aside").getBoundingClientRect().right + 1).map((one) => one.className || one.tagName));
      assert.deepEqual(wide, [], `tab ${key}`);
      const tall = await tab.evaluate(() => [...document.querySelectorAll("button.save")].filter((one) => one.offsetHeight > 28).map((one) => one.textContent));
      assert.deepEqual(tall, [], `tab ${key}`);
    }
  });

  await proves("a difference stands up as one ground, without a line through it", async (at) => {
    const { tab } = await at(`${two}#d=1&view=3d&show=between&layer=read:temperature`);
    await ready(tab);
    await both(tab);
    await legend(tab, "goals and ways of A");
    assert.ok(await tab.locator(".divide").isHidden());
    await shoot(tab, "solid-difference");
  });
};

const fileOf = (name) => join(samplePath(5), "..", name);
