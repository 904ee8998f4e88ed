// What is saved: the map as a figure, the goals as a table.

import type { View } from "../state";
import { save } from "../ui/dom";
import { fileName as fileOf } from "../ui/export";
import { figurePng, figureSvg } from "../ui/figure";
import { clock } from "../ui/format";
import type { GoalTable } from "../ui/goals";
import type { Ground } from "./ground";
import { apart } from "./side";
import { leadOf } from "./lead";
import type { Sides } from "./side";

/** Pixels of a picture to one of the page. */
const FINENESS = 2;

/** The flat map as a figure, with its title, legend and scale. */
export const figureOf = (sides: Sides, ground: Ground): SVGSVGElement | undefined => {
  const run = sides.a?.run;
  const moment = run?.moment(sides.a?.index ?? 0);
  if (!run || !moment) return undefined;
  const { flat } = ground;
  const { viewport } = flat;
  const panels = flat.panels();
  const legend = ground.words(false);
  const b = sides.b?.run;
  const other = b?.moment(sides.b?.index ?? 0);
  return figureSvg({
    title: `${run.facts.run.mission ?? run.facts.name}, decision ${moment.number} at ${clock(moment.timeS)}: ${legend?.title ?? "no map"}`,
    source: b ? `A: ${run.facts.name}; B: ${b.facts.name}, decision ${other?.number ?? 0} at ${clock(other?.timeS ?? 0)}` : run.facts.name,
    panels,
    height: flat.height,
    metresPerPixel: run.facts.grid.spacingM / viewport.scale,
    legend,
    divide: panels[1]?.x,
    apart: apart(sides),
  });
};

const fileName = (view: View, sides: Sides, ending: string): string => {
  const run = sides.a?.run;
  const words = ["map", view.layer.replace(/^.*:/, ""), ...(view.aspect === "value" ? [] : [view.aspect])];
  return run ? fileOf(run, run.moment(sides.a?.index ?? 0), words.join("-"), ending) : `map.${ending}`;
};

export const saveSvg = (view: View, sides: Sides, ground: Ground): void => {
  const svg = figureOf(sides, ground);
  if (svg) save(fileName(view, sides, "svg"), new Blob([new XMLSerializer().serializeToString(svg)], { type: "image/svg+xml" }));
};

/** The figure of the flat map; in three dimensions what is in sight. */
export const savePng = (view: View, sides: Sides, ground: Ground): void => {
  const name = fileName(view, sides, "png");
  if (ground.solid) {
    ground.canvas.toBlob((blob) => blob && save(name, blob));
    return;
  }
  const svg = figureOf(sides, ground);
  if (svg) void figurePng(svg, FINENESS).then((blob) => save(name, blob));
};

export const saveCsv = (view: View, sides: Sides, goals: GoalTable): void => {
  const run = leadOf(sides, view)?.run;
  const moment = run?.moment(view.index);
  if (!run || !moment) return;
  goals.show(moment, run.moment(view.index - 1), run.facts, view.goal);
  save(fileOf(run, moment, "goals", "csv"), new Blob([goals.csv()], { type: "text/csv;charset=utf-8" }));
};
