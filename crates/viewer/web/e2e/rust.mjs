// The command itself: what it serves, and what it says of a log, which is the truth that the page is held against.

import { execFileSync, spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const built = ["debug", "release"].map((profile) => fileURLToPath(new URL(`../../../../target/${profile}/wisdom`, import.meta.url)));
/** The command: WISDOM, or what Cargo built. */
export const command = process.env.WISDOM ?? built.find(existsSync);
if (!command || !existsSync(command)) {
  console.error(`no wisdom command${command ? ` at ${command}` : ""}: build it (cargo build), or name it (WISDOM=path)`);
  process.exit(2);
}

export const sample = (version) => fileURLToPath(new URL(`../../../../logs/sample/paper-decisions-${version}.mcap`, import.meta.url));

/** What the command prints, as JSON. */
export const asked = (...args) => JSON.parse(execFileSync(command, [...args, "--json"], { maxBuffer: 1 << 30 }));

/** The record of a decision. */
export const decision = (log, number) => asked("log", "cat", log, "--topic", "/decision", "--decision", String(number)).message;

/** A run of the sample's mission under another rule, as a log. */
export const otherRun = (rule, folder) => {
  const log = join(folder, `paper-${rule}.mcap`);
  const mission = fileURLToPath(new URL("../../../../missions/paper", import.meta.url));
  const limits = ["budget.energy-j=3.5e5", "goals.expansions=2000", "goals.max-sequenced=8"].flatMap((limit) => ["--set", limit]);
  execFileSync(command, ["run", mission, "--rule", rule, ...limits, "--log", log, "--json"], { stdio: ["ignore", "ignore", "inherit"] });
  return log;
};

/** Writes a report. */
export const report = (...args) => execFileSync(command, ["report", ...args, "--json"]);

/** `wisdom view`, and what it makes again. */
export const view = async (...logs) => {
  const child = spawn(command, ["view", "--no-open", "--json", ...logs], { stdio: ["ignore", "pipe", "inherit"] });
  const line = await new Promise((resolve, reject) => {
    child.stdout.once("data", (data) => resolve(String(data)));
    child.once("exit", (code) => reject(new Error(`wisdom view ended with ${code}`)));
  });
  const { address } = JSON.parse(line);
  const get = async (path) => (await fetch(new URL(path, address))).json();
  return {
    url: address,
    cell: (number, { row, col }, side = "a") => get(`${side}/derived/cell/${number}/${row}/${col}`),
    family: (number, side = "a") => get(`${side}/derived/family/${number}`),
    plane: async (number, name, side = "a") => {
      const view = new DataView(await (await fetch(new URL(`${side}/derived/plane/${number}/${name}`, address))).arrayBuffer());
      const [row, col, rows, cols] = [0, 4, 8, 12].map((at) => view.getUint32(at, true));
      return { rows, cols, at: (cell) => view.getFloat32(16 + 4 * ((cell.row - row) * cols + cell.col - col), true) };
    },
    close: () => child.kill(),
  };
};
