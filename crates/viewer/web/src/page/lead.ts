// Which run the decision panel tells of: that run leads, and the other follows the cursor.

import { sameGround } from "../model/compare";
import { paired } from "../model/pairs";
import type { Store, View } from "../state";
import type { Side, Sides } from "./side";

export const leadOf = ({ a, b }: Sides, view: View): Side | undefined => (view.subject === "b" && b?.run ? b : a);

/** What the goal of one run is called in the other: the goal of the same place there, if there is one. */
const namesake = (from: Side, to: Side, goal: number | undefined): number | undefined => {
  if (goal === undefined || !from.run || !to.run || !sameGround(from.run.facts.grid, to.run.facts.grid)) return undefined;
  const goals = ({ run, index }: Side) => [...(run?.verdictsUpTo(index).values() ?? [])].map(({ verdict }) => verdict.goal);
  const { grid, identityRadiusM } = from.run.facts;
  return paired(goals(from), goals(to), grid, identityRadiusM).find(({ a }) => a?.id === goal)?.b?.id;
};

/** Lets a run lead, at the decision that it stands at; the goal picked out stays the same place. */
export const turnTo = (store: Store, sides: Sides, subject: "a" | "b"): void => {
  const { view } = store;
  const [from, to] = [leadOf(sides, view), sides[subject]];
  if (!from || !to?.run || from === to) return;
  store.set({ subject, index: to.index, option: undefined, goal: namesake(from, to, view.goal) });
};

/** Puts both runs where the view asks. A mere change of who leads moves neither. */
export const follow = (sides: Sides, view: View, always: boolean): void => {
  const lead = leadOf(sides, view);
  if (!lead) return;
  const moved = lead.index !== view.index;
  lead.index = view.index;
  const moment = lead.run?.moment(view.index);
  const other = lead === sides.a ? sides.b : sides.a;
  if (moment && other && (moved || always)) other.follow(view.index, moment.timeS, view.axis);
};
