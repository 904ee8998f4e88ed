// The shapes of goals: colour is never the only difference.

import type { GoalState } from "../model/states";
import { OKABE } from "./colour";

export const stateColour: Record<GoalState, string> = {
  next: OKABE.vermilion,
  planned: OKABE.orange,
  deferred: OKABE.sky,
  done: OKABE.green,
  dropped: OKABE.grey,
};

/** The outline of a mark around the origin, of a radius; shared by canvas (as a Path2D) and SVG. */
export const markPath = (state: GoalState, r: number): string => {
  const n = (value: number): string => value.toFixed(2);
  switch (state) {
    case "next":
    case "planned":
      return `M${n(-r)} 0A${n(r)} ${n(r)} 0 1 1 ${n(r)} 0A${n(r)} ${n(r)} 0 1 1 ${n(-r)} 0Z`;
    case "deferred": {
      const d = r * 1.05;
      return `M0 ${n(-d)}L${n(d)} 0L0 ${n(d)}L${n(-d)} 0Z`;
    }
    case "done": {
      const s = r * 0.86;
      return `M${n(-s)} ${n(-s)}H${n(s)}V${n(s)}H${n(-s)}Z`;
    }
    case "dropped": {
      const c = r * 0.7;
      return `M${n(-c)} ${n(-c)}L${n(c)} ${n(c)}M${n(c)} ${n(-c)}L${n(-c)} ${n(c)}`;
    }
  }
};

/** The radius of the mark of a goal that matters now. */
export const MARK_PX = 8.5;

export const markRadius = (state: GoalState): number => (state === "dropped" || state === "deferred" ? MARK_PX * 0.68 : MARK_PX);

/** What is written in a mark: the turn, or that the goal is done. */
export const markText = ({ state, turn }: { state: GoalState; turn: number | undefined }): { text: string; colour: string } | undefined => {
  if (turn !== undefined) return { text: String(turn + 1), colour: state === "next" ? "#fff" : "#111" };
  return state === "done" ? { text: "✓", colour: "#fff" } : undefined;
};

/** A dropped goal is a cross, which has no inside. */
export const filled = (state: GoalState): boolean => state !== "dropped";

const paths = new Map<string, Path2D>();

export const markPath2d = (state: GoalState, r: number): Path2D => {
  const key = `${state}${r}`;
  const known = paths.get(key) ?? new Path2D(markPath(state, r));
  paths.set(key, known);
  return known;
};

const SVG = "http://www.w3.org/2000/svg";

/** A mark to stand in text. */
export const markIcon = (state: GoalState): SVGSVGElement => {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "-8 -8 16 16");
  svg.setAttribute("class", `mark mark-${state}`);
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", markPath(state, 5.4));
  path.setAttribute("fill", filled(state) ? stateColour[state] : "none");
  path.setAttribute("stroke", filled(state) ? "var(--mark-edge)" : stateColour[state]);
  path.setAttribute("stroke-width", filled(state) ? "1" : "2.2");
  svg.append(path);
  return svg;
};
