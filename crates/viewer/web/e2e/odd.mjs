// Logs that are large, strange or hostile.

import assert from "node:assert/strict";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { crowded, putTogether, repeated, takeApart, topicOf, withTexts } from "./forge.mjs";

const done = (tab) => tab.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 120_000 });
/** By way of the disk: a file may be large. */
const give = async (tab, name, bytes) => {
  const file = join(mkdtempSync(join(tmpdir(), "wisdom-odd-")), name.replaceAll("/", "_"));
  writeFileSync(file, bytes);
  await tab.locator('input[type="file"]').setInputFiles(file);
};
const topics = (tab) => tab.locator(".topics tbody tr").evaluateAll((rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
const watched = async (at, url) => {
  const visited = await at("about:blank");
  await visited.tab.addInitScript(() => {
    window.long = [];
    new PerformanceObserver((list) => window.long.push(...list.getEntries().map(({ duration }) => Math.round(duration)))).observe({ entryTypes: ["longtask"] });
  });
  await visited.tab.goto(url);
  return visited;
};
const longest = (tab) => tab.evaluate(() => Math.max(0, ...window.long.splice(0)));

/** Markup, a mark that turns text round, a character that cannot be seen; now and then a hundred thousand letters. */
const EVIL = `<img src=x onerror="window.owned=1"><script>window.owned=1</script>\u202Eevil\u2066\u0000\u0007"'&`;

/** What the browser calls long is 50 ms; a machine that is at other work too takes some times that. */
const LONGEST_MS = 250;

export const odd = async ({ proves, shoot, bare, sample, timings }) => {
  const log = await takeApart(sample);

  await proves("whatever the texts of a log are, they are shown as text and keep to their place", async (at) => {
    let told = 0;
    const hostile = await putTogether(withTexts(log, (text) => (text === "" ? "" : (told += 1) % 9 === 0 ? EVIL + "W".repeat(100_000) : EVIL + text)));
    assert.ok(told > 1000, `${told} texts`);
    const { tab } = await at(bare);
    await give(tab, `${EVIL.replaceAll(/[\u0000\u0007]/g, "")}.mcap`, hostile);
    await done(tab);
    let shortened = 0;
    for (const key of ["1", "2", "3", "4"]) {
      await tab.keyboard.press(key);
      await tab.waitForTimeout(250);
      const found = await tab.evaluate(() => ({
        owned: window.owned,
        images: document.querySelectorAll("img, aside script").length,
        wide: [...document.querySelectorAll("body, header, aside, .pages, .page, .decision")].filter((one) => one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).overflowX !== "hidden" && one.clientWidth > 0).map((one) => one.className || one.tagName),
        turned: /[\u202E\u2066\u0000]/.test(document.body.innerText),
        text: document.querySelector("aside").innerText,
      }));
      assert.equal(found.owned, undefined);
      assert.equal(found.images, 0);
      assert.deepEqual(found.wide, [], `tab ${key}`);
      assert.equal(found.turned, false);
      assert.match(found.text, /<img src=x onerror="window\.owned=1">.*⟨U\+202E⟩evil/);
      if (/characters more\)/.test(found.text)) shortened += 1;
    }
    assert.ok(shortened > 0, "a long text is shown by its beginning");
    assert.ok(await tab.locator("canvas.map").isVisible());
    const map = await tab.locator("canvas.map").boundingBox();
    assert.ok(map.width > 600 && map.height > 300, "the map keeps its room");
    await shoot(tab, "hostile");
  });

  await proves("a log without decisions lists what it holds", async (at) => {
    const { tab } = await at(bare);
    await give(tab, "idle.mcap", await putTogether({ ...log, messages: log.messages.filter((message) => topicOf(log, message) !== "/decision") }));
    await done(tab);
    assert.match(await tab.locator(".banner").innerText(), /^idle\.mcap: no decision is to be had/);
    const listed = await topics(tab);
    assert.deepEqual(listed.find(([topic]) => topic === "/in/outcome")?.[2], String(log.messages.filter((message) => topicOf(log, message) === "/in/outcome").length));
    assert.match(await tab.locator(".checks").innerText(), /CRC of the data section: right; of the summary: right/);
  });

  await proves("another program's log has its topics listed with their counts, those of our names too", async (at) => {
    const channels = [["/chatter", 1, "ros1"], ["/decision", 0, "json"], ["/log", 1, "ros1"]].map(([topic, schemaId, messageEncoding], id) => ({ id, topic, schemaId, messageEncoding, metadata: new Map() }));
    const messages = Array.from({ length: 30 }, (_, i) => ({ channelId: i % 3, sequence: i, logTime: BigInt(i), publishTime: BigInt(i), data: new TextEncoder().encode('{"a":1}') }));
    const schemas = [{ id: 1, name: "std_msgs/String", encoding: "ros1msg", data: new TextEncoder().encode("string data") }];
    const { tab } = await at(bare);
    await give(tab, "robot.mcap", await putTogether({ schemas, channels, messages, metadata: [], attachments: [] }));
    await done(tab);
    const listed = await topics(tab);
    assert.deepEqual(listed.map(([topic, , count]) => [topic, count]), [["/chatter", "10"], ["/decision", "10"], ["/log", "10"]]);
    assert.match(listed[0][4], /not shown here/);
    assert.match(listed[1][4], /10 not decoded: .+/);
    await shoot(tab, "another");
  });

  await proves("a file that is no MCAP is said to be none, and the next one opens", async (at) => {
    const { tab } = await at(bare);
    await give(tab, "letter.txt", Buffer.from("a letter from home"));
    await done(tab);
    assert.match(await tab.locator(".banner").innerText(), /letter\.txt: no decision is to be had\. This is not an MCAP file \(18 bytes\)/);
    await give(tab, "paper.mcap", sample);
    await tab.waitForFunction(() => document.querySelector("aside .title h2")?.textContent === "Decision 0 of 0 … 4");
    assert.ok(await tab.locator("canvas.map").isVisible());
    assert.ok(await tab.locator(".banner").isHidden());
  });

  await proves("five hundred goals are all listed, and no step waits for them", async (at) => {
    const { tab } = await watched(at, bare);
    await give(tab, "crowd.mcap", await putTogether(crowded(log, 500)));
    await done(tab);
    const rows = tab.locator(".goal-table tr.goal");
    await tab.waitForFunction(() => document.querySelectorAll(".goal-table tr.goal").length === 500);
    await longest(tab);
    for (let i = 0; i < 4; i++) {
      await tab.keyboard.press("ArrowRight");
      await tab.waitForTimeout(150);
    }
    timings.goals500StepMs = await longest(tab);
    assert.ok(timings.goals500StepMs < LONGEST_MS, `${timings.goals500StepMs} ms`);
    await tab.waitForFunction(() => document.querySelectorAll(".goal-table tr.goal").length === 500);
    await tab.keyboard.press("/");
    await tab.keyboard.type("G10499");
    await tab.waitForFunction(() => document.querySelectorAll(".goal-table tr.goal").length === 1);
    assert.match(await rows.innerText(), /G10499/);
  });

  await proves("a thousand decisions come in, are scrubbed and stepped, and the page never stands still", async (at) => {
    const without = ["/scene", "/terrain/interest", "/in/observation", "/tf", "/rover/pose"];
    const long = await putTogether(repeated(log, 200, { without }), { chunkSize: 120_000 });
    const { tab } = await watched(at, bare);
    await give(tab, "long.mcap", long);
    await tab.waitForFunction(() => document.documentElement.dataset.drawn !== undefined);
    await done(tab);
    timings.longLogMb = Math.round(long.length / 1e6);
    timings.longLogLoadMs = await longest(tab);
    assert.equal(await tab.locator("aside .title h2").innerText(), "Decision 0 of 0 … 999");
    const box = await tab.locator("canvas.lanes").boundingBox();
    await tab.mouse.move(box.x + 100, box.y + 33);
    await tab.mouse.down();
    await tab.mouse.move(box.x + box.width - 130, box.y + 33, { steps: 20 });
    await tab.mouse.up();
    for (const key of ["End", "ArrowLeft", "t", "4", "3", "1", "Home"]) {
      await tab.keyboard.press(key);
      await tab.waitForTimeout(150);
    }
    await tab.waitForFunction(() => document.querySelector("aside .title h2").textContent === "Decision 0 of 0 … 999");
    timings.longLogStepMs = await longest(tab);
    assert.ok(timings.longLogLoadMs < LONGEST_MS, `loading: a task of ${timings.longLogLoadMs} ms`);
    assert.ok(timings.longLogStepMs < LONGEST_MS, `stepping: a task of ${timings.longLogStepMs} ms`);
  });
};
