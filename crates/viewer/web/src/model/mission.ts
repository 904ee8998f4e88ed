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

/** What a mission that says nothing asks of a new plan. */
const HYSTERESIS = 0.05;

/** A number of one part of the file, as it was changed against the file if it was. */
const numberOf = (part: string, key: string, overrides: string, path: string): number | undefined => {
  const changed = overrides.split("\n").find((line) => line.startsWith(`${path}=`))?.slice(path.length + 1);
  const found = changed ?? new RegExp(`^${key}\\s*=\\s*([^#\\n]*)`, "m").exec(part)?.[1]?.trim();
  const value = found ? Number(found.replaceAll("_", "")) : Number.NaN;
  return Number.isFinite(value) ? value : undefined;
};

/** By what share a new plan must be better than the committed one. */
export const hysteresis = (mission: string, overrides: string): number | undefined => {
  if (mission === "") return undefined;
  const own = mission.split(/^\[goals\]/m)[1]?.split(/^\[/m)[0] ?? "";
  return numberOf(own, "hysteresis", overrides, "goals.hysteresis") ?? HYSTERESIS;
};

/** Each directive's factor on the prize. */
export const weights = (mission: string, overrides: string): Map<string, number> =>
  new Map(
    mission.split(/^\[\[directive\]\]/m).slice(1).flatMap((part, i): [string, number][] => {
      const own = part.split(/^\[/m)[0] ?? "";
      const name = /^name\s*=\s*"([^"]*)"/m.exec(own)?.[1];
      return name === undefined ? [] : [[name, numberOf(own, "weight", overrides, `directive.${i}.weight`) ?? 1]];
    }),
  );

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
