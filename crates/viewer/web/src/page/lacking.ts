// What is said where a layer is not to be had, or is not quite what it seems.

import { DERIVED } from "../planes";
import type { View } from "../state";
import { apart } from "./side";
import type { Side, Sides } from "./side";

/** Why there is no map. */
export const whyNone = (view: View, sides: Sides): string => {
  if (view.aspect === "change" && sides.a?.index === 0) return "There is no decision before this one.";
  if (view.aspect === "between" && apart(sides)) return "The grids of the two runs differ: their maps cannot be compared.";
  if (view.aspect === "between") return `Not both runs hold this map at these decisions.${sides.b?.lacks ? ` B: ${sides.b.lacks}.` : ""}`;
  return "There is no such map at this decision.";
};

/** Why one run lacks the layer, if nothing went wrong. */
export const whyLacking = (view: View, { run, index, derivable }: Side): string => {
  if (!run?.moment(index)) return "no decision of it was read";
  if (view.layer.startsWith(DERIVED) && derivable && "unavailable" in derivable) return derivable.unavailable || "nothing is derived of it here";
  if (view.aspect === "change" && index === 0) return "there is no decision before this one";
  return "none at this decision";
};

/** What must be known of the map not to be misled by it. */
export const cautions = (view: View, sides: Sides, solid: boolean, missing: string, waiting: boolean): string[] => {
  const { a, b } = sides;
  const stale = waiting && a?.run && a.planeIndex !== undefined && a.planeIndex !== a.index ? [`faded: of decision ${a.run.moment(a.planeIndex)?.number ?? 0}`] : [];
  if (!a || !b?.run) return stale;
  const one = a.plane ? [] : [`A: ${missing || "no such map"}`];
  const other = b.plane || b.planeIndex === undefined ? [] : [`B: no such map: ${b.lacks}`];
  const ground = apart(sides) ? [`other ground: no cell of A is one of B${solid && !b.relief ? ", and of B no heights are known" : ""}`] : [];
  const whose = solid && view.aspect === "between" ? ["goals and ways of A"] : [];
  return [...stale, ...one, ...other, ...ground, ...whose];
};
