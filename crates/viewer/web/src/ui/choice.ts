// The choice in words: why a better plan was left aside, and why this goal comes first.

import { heldPlans, otherwiseBegun } from "../model/choice";
import type { Moment, PlanOption } from "../model/types";
import { orderOf } from "../view/family";
import { apart, excess } from "./compared";
import { against, chance, goalName, plain } from "./format";

const percent = (part: number): string => `${Number((100 * part).toPrecision(3))} %`;

/** What a change would have had to gain; nothing where the mission's file does not say. */
const asked = (best: PlanOption, kept: PlanOption, hysteresis: number | undefined): string => {
  if (hysteresis === undefined) return "a change must gain more than that";
  if (best.value === kept.value) return `a plan of equal value must be ${percent(hysteresis)} more reliable`;
  return `a change must gain at least ${plain(hysteresis * Math.abs(kept.value))}, ${percent(hysteresis)} of what is kept`;
};

/** That a better plan was known and the old one kept; nothing if the best was taken. */
export const heldWords = (moment: Moment, hysteresis: number | undefined): string | undefined => {
  const held = heldPlans(moment);
  if (!held) return undefined;
  const { best, kept } = held;
  return `best found ${plain(best.value, 1)}, kept ${plain(kept.value, 1)} (${excess(kept.value, best.value, plain)}); ${asked(best, kept, hysteresis)}`;
};

/** The same in a line. */
export const heldLine = (moment: Moment, hysteresis: number | undefined): string | undefined => {
  const held = heldPlans(moment);
  if (!held) return undefined;
  const { best, kept } = held;
  const known = "a better plan is known, the old one kept";
  if (best.value === kept.value) return `${known}: of equal value, but more reliable by ${excess(best.reliability, kept.reliability, chance)}`;
  const gain = `${excess(best.value, kept.value, plain)} (${apart(kept.value, best.value, plain).join(" → ")})`;
  return hysteresis === undefined ? `${known}: ${gain} is too little` : `${known}: ${gain} is less than ${plain(hysteresis * Math.abs(kept.value))}, the ${percent(hysteresis)} that a change must gain`;
};

/** Why the first goal is first: what the chosen plan is worth beside the best one that begins otherwise. */
export const firstWords = (moment: Moment): string | undefined => {
  const chosen = moment.family[moment.chosen];
  const first = chosen?.order[0];
  if (!chosen || first === undefined) return undefined;
  const name = goalName(first);
  const other = otherwiseBegun(moment);
  const pinned = moment.underway === first ? `; the leg under way stays first while it is safe` : "";
  if (!other && moment.family.length > 1) return `every plan of the family begins with ${name}${pinned}`;
  const begins = moment.held ? `the plan kept begins with ${name}` : `the best of the ${moment.family.length} plans of the family begins with ${name}`;
  const beside = other
    ? `; best with another first: ${orderOf({ ...other, order: other.order.slice(0, 3) })}${other.order.length > 3 ? " › …" : ""}, value ${against(other.value, chosen.value, plain)}, reliability ${against(other.reliability, chosen.reliability, chance)}`
    : "";
  return `${begins}${beside}${pinned}`;
};
