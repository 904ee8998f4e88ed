// The little that is asked of the mission file: the experts' order, how layers are updated, and what their values are.
//
// This is no TOML reader. It knows the two shapes that mission files have there, and says nothing of any other.

import type { Update } from "./plane";

/** Names of the experts, in the order of the credits. */
export const experts = (mission: string): string[] => {
  const found = /^experts\s*=\s*\[([^\]]*)\]/m.exec(mission)?.[1] ?? "";
  return [...found.matchAll(/"([^"]+)"/g)].map(([, path]) => (path ?? "").replace(/^.*\//, "").replace(/\.toml$/, ""));
};

/** What a mission that says nothing takes for one place. */
const IDENTITY_RADIUS_M = 8;

/** Goals of one directive nearer than this are of one place. */
export const identityRadiusM = (mission: string): number =>
  Number(/^identity-radius-m\s*=\s*([\d.]+)/m.exec(mission)?.[1] ?? IDENTITY_RADIUS_M);

interface LayerFacts {
  update: Update;
  unit: string;
  /** Values that stand for classes; empty where they are amounts. */
  classes: number[];
}

/** What the mission says of each of its layers. */
export const layers = (mission: string): Map<string, LayerFacts> => {
  const facts = new Map<string, LayerFacts>();
  for (const part of mission.split(/^\[\[layer\]\]/m).slice(1)) {
    const own = part.split(/^\[/m)[0] ?? "";
    const value = (key: string): string => new RegExp(`^${key}\\s*=\\s*"([^"]*)"`, "m").exec(own)?.[1] ?? "";
    const update = value("update");
    const classes = /^classes\s*=\s*\[([^\]]*)\]/m.exec(own)?.[1]?.split(",").filter((part) => part.trim() !== "").map(Number).filter(Number.isFinite) ?? [];
    facts.set(value("name"), {
      update: update === "latest" || update === "weighted" ? update : "best",
      unit: value("unit"),
      classes: value("kind") === "class" ? classes : [],
    });
  }
  return facts;
};
