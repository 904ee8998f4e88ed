// Price tags: what it would have taken to bring a goal in, in the words of `wisdom explain`.

import type { Limits, Price, PriceTag } from "../derived/types";
import { h } from "./dom";
import { against, chance, clock, energy, plain, term } from "./format";

/** What stands in the way, as a sentence goes on. */
const BARRIERS: Record<string, string> = {
  time: "it needs more time too",
  energy: "it needs more energy too",
  data: "it needs more data volume",
  risk: "it needs a lower floor too",
  preconditions: "facts, order or the leg under way rule it out",
  "beyond-exact": "it was not among the goals sequenced",
  unreachable: "no pose of it can be reached",
  outweighed: "other goals are worth more",
  held: "it would be better, but not by enough",
  excluded: "a goal beside it stands for its place",
  "search-cut": "no sequence with it was met",
};

/** Reasons that are no lever. */
const UNPRICED: Record<string, string> = {
  data: "not priced: data volume is no lever",
  window: "not priced: windows are no lever",
};

/** By what a decision could have been changed, and the price of it. */
export const priceLines = (tag: PriceTag, limits: Limits, reason = ""): { levers: string; words: string }[] => {
  const instead = (was: number | undefined, change: number, written: (value: number) => string): string =>
    was === undefined ? "" : ` (${written(was + change)} instead of ${written(was)})`;
  const all: [string, string][] = [
    ["energy", priced(tag.energyJ, (x) => `${energy(x)} more${instead(limits.energyJ, x, energy)}`)],
    ["time", priced(tag.timeS, (x) => `${x.toFixed(0)} s more${instead(limits.timeS, x, clock)}`)],
    ["floor", priced(tag.reliability, (x) => `reliability floor ${chance(x)} lower${instead(limits.minReliability, -x, chance)}`)],
    ["interest", priced(tag.prize, (x) => interest(tag, x))],
  ];
  // What stands in the way is always spoken of, if only to say that it has no price.
  const unpriced = UNPRICED[reason];
  if (unpriced) all.unshift([reason, unpriced]);
  // Levers of which the same is to be said share a line.
  const lines: { levers: string; words: string }[] = [];
  for (const [lever, words] of all) {
    const last = lines.at(-1);
    if (last?.words === words) last.levers += `, ${lever}`;
    else lines.push({ levers: lever, words });
  }
  return lines;
};

const interest = ({ interest: wanted, interestWas }: PriceTag, prize: number): string => {
  const higher = `prize ${chance(prize)} higher`;
  if (wanted === undefined) return higher;
  if (wanted > 1) return `${higher}: more than an interest of 1 is worth here`;
  return `${chance(wanted)}${interestWas === undefined ? "" : ` instead of ${chance(interestWas)}`} (${higher})`;
};

const priced = (price: Price, words: (change: number) => string): string => {
  if (price.kind === "unknown") return "unknown: the search for it ended first";
  if (price.kind === "nothing") {
    const told = price.exact ? "none does it" : "none that was tried does it";
    const terms = price.terms.map(term).join(", ");
    return `${told}: ${BARRIERS[price.why] ?? `it was given up, ${price.why}`}${terms ? `; ${terms}` : ""}`;
  }
  const known = price.exact ? "" : ", the least of those tried";
  const applied = price.confirmed === undefined ? "" : price.confirmed ? "; applied: it is in, and out at 1 % less" : "; applied: NOT CONFIRMED";
  return `${words(price.least)}${known}${applied}`;
};

/** What the decision chose, to hold a plan with the goal against. */
export interface Beside {
  reason: string;
  value: number;
  reliability: number;
}

const LEVERS: Record<string, string> = {
  energy: "with the energy it asks for",
  time: "with the time it asks for",
  reliability: "with the floor it asks for",
};

/** The best plan with the goal in it: "G8 › G6: value 8.527 (−0.0061), …; displaces G10 (with the energy it asks for)". */
export const withItLine = ({ withIt }: PriceTag, beside: Beside | undefined): string | undefined => {
  if (!withIt) return undefined;
  const { order, displaced, value, reliability, timeS, energyJ, lever } = withIt;
  const numbers = [
    `value ${beside ? against(value, beside.value, plain) : plain(value)}`,
    `reliability ${beside ? against(reliability, beside.reliability, chance) : chance(reliability)}`,
    clock(timeS),
    energy(energyJ),
  ];
  const out = displaced.length > 0 ? `displaces ${displaced.join(", ")}` : "displaces nothing";
  const by = lever === undefined ? "" : ` (${LEVERS[lever] ?? lever})`;
  return `${order.join(" › ")}: ${numbers.join(", ")}; ${out}${by}`;
};

export const priceList = (tag: PriceTag, limits: Limits, beside?: Beside): HTMLElement => {
  const plan = withItLine(tag, beside);
  const lines = [...priceLines(tag, limits, beside?.reason), ...(plan === undefined ? [] : [{ levers: "with it", words: plan }])];
  return h("dl", { class: "prices" }, lines.flatMap(({ levers, words }) => [h("dt", {}, levers), h("dd", {}, words)]));
};
