// The moment in the page's address: #d=7&tab=plans&goal=6 is decision 7 with its plans, goal 6 picked out.
//
// Stepping rewrites the address, so that the way back is not a step at a time; what is chosen besides (a tab, a layer, a
// goal) can be gone back to.

import type { Run } from "../model/run";
import type { View } from "../state";

/** What the address holds besides the decision. */
export type Held = Pick<View, "layer" | "goal" | "tab" | "axis" | "aspect" | "split" | "solid" | "probe" | "probed" | "subject">;

const DEFAULTS: Held = { layer: "map:interest", goal: undefined, tab: "goals", axis: "time", aspect: "value", split: "wipe", solid: false, probe: undefined, probed: "a", subject: "a" };

const among = <T extends string>(found: string | null, of: readonly T[], otherwise: T): T => of.find((one) => one === found) ?? otherwise;

const whole = (text: string | null | undefined): number | undefined => (text && /^\d{1,9}$/.test(text) ? Number(text) : undefined);

/** The address's own words; what is as it is by default is left out. */
export const written = (decision: number, view: Held): string => {
  const words: [string, string][] = [["d", String(decision)]];
  if (view.layer !== DEFAULTS.layer && view.layer !== "") words.push(["layer", view.layer]);
  if (view.aspect !== DEFAULTS.aspect) words.push(["show", view.aspect]);
  if (view.split !== DEFAULTS.split) words.push(["split", view.split]);
  if (view.solid) words.push(["view", "3d"]);
  if (view.goal !== undefined) words.push(["goal", String(view.goal)]);
  if (view.tab !== DEFAULTS.tab) words.push(["tab", view.tab]);
  if (view.axis !== DEFAULTS.axis) words.push(["axis", view.axis]);
  if (view.probe) words.push(["cell", `${view.probe.row},${view.probe.col}`]);
  if (view.probe && view.probed !== DEFAULTS.probed) words.push(["of", view.probed]);
  if (view.subject !== DEFAULTS.subject) words.push(["run", view.subject]);
  // Colons and commas may stand in a fragment as they are.
  return `#${words.map(([key, value]) => `${key}=${encodeURIComponent(value).replaceAll("%3A", ":").replaceAll("%2C", ",")}`).join("&")}`;
};

/** What an address asks for; nonsense in it counts for nothing. */
export const asked = (hash: string): { decision: number | undefined; view: Held } => {
  const words = new URLSearchParams(hash.replace(/^#/, ""));
  const [row, col] = (words.get("cell") ?? "").split(",").map(whole);
  return {
    decision: whole(words.get("d")),
    view: {
      layer: words.get("layer") ?? DEFAULTS.layer,
      goal: whole(words.get("goal")),
      tab: among(words.get("tab"), ["goals", "changes", "plans", "run", "other"], DEFAULTS.tab),
      axis: among(words.get("axis"), ["time", "decision"], DEFAULTS.axis),
      aspect: among(words.get("show"), ["value", "change", "between"], DEFAULTS.aspect),
      split: among(words.get("split"), ["wipe", "halves"], DEFAULTS.split),
      solid: words.get("view") === "3d",
      probe: row === undefined || col === undefined ? undefined : { row, col },
      probed: among(words.get("of"), ["a", "b"], DEFAULTS.probed),
      subject: among(words.get("run"), ["a", "b"], DEFAULTS.subject),
    },
  };
};

/** Browsers take some twenty writes a second. */
const PAUSE_MS = 100;

/** Without what changes from step to step. */
const lasting = (hash: string): string =>
  hash
    .replace(/^#/, "")
    .split("&")
    .filter((word) => !/^(d|cell|of)=/.test(word))
    .join("&");

export class Address {
  /** What the address asks for and the page does not show yet. */
  private wanted: { decision?: number; view?: Held } = {};
  /** Whether what comes next follows from the address, and is no step of its own. */
  private following = true;
  /** As it was written or read last. */
  private last = location.hash;
  private next: string | undefined;
  private timer: number | undefined;

  constructor(changed: () => void) {
    this.read();
    window.addEventListener("hashchange", () => {
      if (location.hash === this.last) return;
      this.read();
      changed();
    });
  }

  /** The run whose decision is asked for, while that is not shown yet. */
  get subject(): "a" | "b" | undefined {
    return this.wanted.view?.subject;
  }

  /** What can be shown by now of what was asked for, told once; a layer that is never offered is forgotten at the end. */
  found(run: Run, layers: readonly string[], ended: boolean): { index?: number; view?: Partial<Held> } {
    const { decision, view } = this.wanted;
    const index = decision === undefined ? -1 : run.moments.findIndex((moment) => moment.number === decision);
    if (index >= 0 || ended) delete this.wanted.decision;
    const offered = view !== undefined && layers.includes(view.layer);
    if (view && !offered && !ended) return index >= 0 ? { index } : {};
    delete this.wanted.view;
    const { layer, ...rest } = view ?? {};
    return { ...(index >= 0 ? { index } : {}), ...(view ? { view: { ...rest, ...(offered && layer ? { layer } : {}) } } : {}) };
  }

  /** Nothing is written over a wish that may still come true, and not for every frame. */
  write(decision: number, view: Held): void {
    if (this.wanted.decision !== undefined || this.wanted.view !== undefined) return;
    this.next = written(decision, view);
    if (this.timer !== undefined) return;
    this.put();
    this.timer = window.setTimeout(() => {
      this.timer = undefined;
      this.put();
    }, PAUSE_MS);
  }

  private put(): void {
    const { next } = this;
    if (next === undefined) return;
    this.next = undefined;
    if (next !== location.hash) {
      const step = this.following || lasting(next) === lasting(location.hash);
      if (step) history.replaceState(null, "", next);
      else history.pushState(null, "", next);
    }
    this.last = next;
    this.following = false;
  }

  private read(): void {
    const { decision, view } = asked(location.hash);
    this.wanted = { ...(decision === undefined ? {} : { decision }), view };
    this.following = true;
    this.next = undefined;
    this.last = location.hash;
  }
}
