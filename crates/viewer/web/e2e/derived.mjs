// What is derived from the logs: by `wisdom view` itself, where WISDOM names the program; else values that are easily told
// apart, by the same addresses and in the same shapes.

import { spawn } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [ROWS, COLS] = [101, 101];
const EXPERTS = ["dem", "texture", "infrared"];

const share = (of) => Math.min(1, Math.max(0, of));
/** By name: what a plane holds at a cell of a decision. */
const PLANES = {
  ignorance: { group: "interest", at: (d, row) => share(row / 100 - d / 50) },
  paradox: { group: "interest", at: (_, row, col) => share(col / 200) },
  conflict: { group: "interest", at: (d, row, col) => share((row + col) / 400 + d / 20) },
  contradiction: { group: "interest", at: (_, row, col) => share((row * col) / 10_000) },
  prize: { group: "interest", at: (_, row, col) => share(1 - (row + col) / 200) },
  hazard: { group: "ground", unit: "1/m", at: (_, row) => row / 5000 },
  elevation: { group: "layer", unit: "m", at: (d, row, col) => Math.hypot(row - 50, col - 50) / 10 + d },
  "elevation-u": { group: "uncertainty", at: () => 0.125 },
  temperature: { group: "layer", at: (_, row, col) => 10 + row / 10 + col / 100 },
  "temperature-u": { group: "uncertainty", at: (_, __, col) => share(col / 100) },
  texture: {
    group: "layer",
    classes: ["sand", "gravel", "flagstone", "rock"].map((name, i) => ({ value: i + 1, name })),
    at: (d, row, col) => 1 + ((Math.floor(row / 20) + Math.floor(col / 25) + d) % 4),
  },
  "texture-u": { group: "uncertainty", at: () => 0.25 },
  blocked: { group: "ground", classes: [{ value: 0, name: "open" }, { value: 1, name: "blocked" }], at: (_, row, col) => Number((row % 20) + (col % 20) < 6) },
  reliability: { group: "ground", at: (_, row, col) => (col > 90 ? Number.NaN : share(1 - Math.hypot(row - 50, col - 50) / 100)) },
};
EXPERTS.forEach((expert, i) => {
  ["interesting", "not-interesting", "ignorance", "paradox"].forEach((mass, j) => {
    PLANES[`mass-${mass}-${expert}`] = { group: "mass", label: `m(${mass}) of ${expert}`, at: (_, row) => 0.25 + (j - 1.5) * 0.02 * i * (row / 100) };
  });
  PLANES[`credit-${expert}`] = { group: "credit", label: `credit of ${expert}`, at: (_, row, col) => (row < 5 ? Number.NaN : Math.sin(row / 15 + i) * Math.cos(col / 15)) };
});

const window = (decision, name) => {
  const bytes = Buffer.alloc(16 + 4 * ROWS * COLS);
  [0, 0, ROWS, COLS].forEach((word, i) => bytes.writeUInt32LE(word, 4 * i));
  for (let row = 0; row < ROWS; row++) for (let col = 0; col < COLS; col++) bytes.writeFloatLE(PLANES[name].at(decision, row, col), 16 + 4 * (row * COLS + col));
  return bytes;
};

const index = () => ({ planes: Object.entries(PLANES).map(([name, { group, label, unit, classes }]) => ({ name, label: label ?? name, unit: unit ?? "1", group, classes })), experts: EXPERTS });

const known = (value) => (Number.isNaN(value) ? null : value);
const cell = (decision, row, col) => {
  const at = (name) => known(PLANES[name].at(decision, row, col));
  return {
    planes: Object.fromEntries(Object.keys(PLANES).filter((name) => !/^(mass|credit)-/.test(name)).map((name) => [name, at(name)])),
    experts: EXPERTS.map((name) => ({
      name,
      masses: { interesting: at(`mass-interesting-${name}`), not_interesting: at(`mass-not-interesting-${name}`), ignorance: at(`mass-ignorance-${name}`), paradox: at(`mass-paradox-${name}`) },
      credit: at(`credit-${name}`),
    })),
  };
};

/** Ways with corners, to be told from straight ones. */
const family = () => ({
  plans: Array.from({ length: 12 }, (_, plan) => ({ cells: Array.from({ length: 30 }, (_, i) => [50 - Math.min(i, 15) + plan, 50 + Math.max(0, i - 15) - 2 * plan]) })),
});

const prices = () => ({
  limits: { energy_j: 250_000, time_s: 40_020, min_reliability: 0.5 },
  left_out: Array.from({ length: 60 }, (_, goal) => ({
    goal: `G${goal}`,
    interest: 0.8,
    price: {
      energy_j: { least: 1000 * (goal + 1), exact: true, confirmed: true },
      time_s: { nothing: "outweighed", exact: true, terms: [{ name: "value with it", value: 0.9, limit: 1.9 }] },
      reliability: { nothing: "outweighed", exact: true, terms: [{ name: "value with it", value: 0.9, limit: 1.9 }] },
      prize: { least: 0.05, exact: false, confirmed: false },
      interest: 0.85,
    },
  })),
});

const later = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Answers an address under `derived/` with made-up values. */
const pretend = async (path) => {
  const [what, decision, ...rest] = path.split("/").map(decodeURIComponent);
  const json = (of) => ({ status: 200, type: "application/json", body: JSON.stringify(of) });
  if (what === "index") return json(index());
  if (what === "plane" && PLANES[rest[0]]) return { status: 200, type: "application/octet-stream", body: window(Number(decision), rest[0]) };
  if (what === "cell") return json(cell(Number(decision), Number(rest[0]), Number(rest[1])));
  if (what === "family") return json(family());
  if (what === "prices") {
    await later(400);
    return json(prices());
  }
  return { status: 404, type: "application/json", body: JSON.stringify({ error: `there is no ${path}` }) };
};

/** Serves both logs by `wisdom view`, and asks it. */
const real = async (program, logs) => {
  const folder = mkdtempSync(join(tmpdir(), "wisdom-viewer-"));
  const files = logs.map((log, i) => join(folder, `${i}.mcap`));
  files.forEach((file, i) => writeFileSync(file, logs[i]));
  const child = spawn(program, ["view", ...files, "--no-open"], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((resolve, reject) => {
    child.on("exit", (code) => reject(new Error(`${program} view ended with ${code}`)));
    child.stdout.once("data", (bytes) => resolve(bytes.toString().split("\n")[0].trim()));
  });
  const derive = async (path, side) => {
    const answer = await fetch(`${url}${side}/derived/${path}`);
    return { status: answer.status, type: answer.headers.get("content-type"), body: Buffer.from(await answer.arrayBuffer()) };
  };
  return { derive, close: () => child.kill() };
};

/** Who answers what is asked of the logs. */
export const deriver = (logs) => (process.env.WISDOM ? real(process.env.WISDOM, logs) : { derive: pretend, close: () => undefined });
