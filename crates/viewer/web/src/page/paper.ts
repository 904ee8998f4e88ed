// What of the page is put on paper.

import type { Panel } from "../ui/panel";
import { figureOf } from "./exports";
import type { Ground } from "./ground";
import { pictureOf } from "./print";
import type { Printed } from "./print";
import type { Sides } from "./side";
import type { TimePane } from "./time-pane";

/** A sheet, in the units of a figure. */
const SHEET_WIDTH = 800;
const SHEET_HEIGHT = 1080;

export const paperOf = (sides: Sides, facts: HTMLElement, ground: Ground, panel: Panel, time: TimePane): Printed | undefined => {
  const { a, b } = sides;
  if (!a?.run) return undefined;
  panel.showAll({ run: a.run, index: a.index }, b?.run && { run: b.run, index: b.index });
  const decided = a.run.moments.length > 0;
  return {
    title: `Wisdom: ${a.run.facts.run.mission ?? a.run.facts.name}`,
    facts,
    map: ground.solid ? pictureOf(ground.canvas) : figureOf(sides, ground),
    legend: ground.solid ? ground.legend.element : undefined,
    ...panel.parts(),
    timeline: decided ? time.sheets(SHEET_WIDTH, SHEET_HEIGHT) : [],
    trends: decided ? panel.run.figure(a.run) : undefined,
  };
};
