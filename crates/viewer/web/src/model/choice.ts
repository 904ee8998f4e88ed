// What the plan family says of the choice: what was best, what was kept, what would have begun otherwise.

import type { Moment, PlanOption } from "./types";

export interface Held {
  best: PlanOption;
  kept: PlanOption;
}

/** The best plan found, where the committed one was kept in its place. */
export const bestFound = (moment: Moment): number | undefined => (moment.held && moment.chosen !== 0 && moment.family.length > 0 ? 0 : undefined);

/** Both plans of a decision that kept the committed one although a better one was known. */
export const heldPlans = (moment: Moment): Held | undefined => {
  const [best, kept] = [moment.family[bestFound(moment) ?? -1], moment.family[moment.chosen]];
  return best && kept ? { best, kept } : undefined;
};

/** The family's best plan that begins with another goal than the one chosen; the family stands best first. */
export const otherwiseBegun = (moment: Moment): PlanOption | undefined => {
  const first = moment.family[moment.chosen]?.order[0];
  return first === undefined ? undefined : moment.family.filter(({ order }) => order.length > 0 && order[0] !== first).sort((a, b) => b.value - a.value)[0];
};

export interface Variants {
  /** Always in sight: the first of its order, the one chosen and the best found. */
  shown: number[];
  /** Other ways and services for the same goals in the same order. */
  folded: number[];
}

/** Members of the family by their order of goals. */
export const variants = (moment: Moment): Variants[] => {
  const orders = new Map<string, Variants>();
  const best = bestFound(moment);
  moment.family.forEach(({ order }, index) => {
    const key = order.join();
    const group = orders.get(key) ?? { shown: [], folded: [] };
    orders.set(key, group);
    if (index === moment.chosen || index === best) {
      // What stands for the order until one of these comes need not.
      group.folded.push(...group.shown.filter((one) => one !== moment.chosen && one !== best));
      group.shown = [...group.shown.filter((one) => one === moment.chosen || one === best), index];
    } else if (group.shown.length === 0) group.shown.push(index);
    else group.folded.push(index);
  });
  return [...orders.values()];
};
