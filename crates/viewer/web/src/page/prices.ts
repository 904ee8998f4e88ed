// The prices of goals that were left out: asked for when they are wanted, because they take a while to work out.

import type { Prices } from "../derived/types";
import { h } from "../ui/dom";
import { goalName } from "../ui/format";
import { PUT_IN } from "../ui/notices";
import { priceList } from "../ui/prices";
import type { Beside } from "../ui/prices";
import type { Store } from "../state";
import { leadOf } from "./lead";
import type { Side, Sides } from "./side";

export class PriceTags {
  /** What stands in a goal's detail, by decision and goal: it lasts while the detail is made anew around it. */
  private readonly tags = new Map<string, HTMLElement>();
  private of: Side | undefined;

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
  ) {}

  /** The place of a goal's prices. */
  tag(goal: number, decision: number): HTMLElement {
    const side = leadOf(this.sides, this.store.view);
    if (this.of !== side) {
      this.tags.clear();
      this.of = side;
    }
    const key = `${decision}/${goal}/${side?.derivable !== undefined}`;
    const known = this.tags.get(key);
    if (known) return known;
    const made = h("div", { class: "price-tag", "aria-live": "polite" });
    this.tags.set(key, made);
    const index = side?.derivable;
    if (index && "unavailable" in index) made.append(h("p", { class: "sub" }, index.unavailable ? `no prices: ${index.unavailable}` : `what it would have taken: wisdom view LOG, or wisdom explain LOG; whoever sends this page puts it in by ${PUT_IN}`));
    // What is inside the page need not be waited for.
    else if (index?.inside) this.ask(made, goal, decision);
    else made.append(h("button", { type: "button", onclick: () => this.ask(made, goal, decision) }, "What would it have taken?"));
    return made;
  }

  private ask(place: HTMLElement, goal: number, decision: number): void {
    const { of: side } = this;
    if (!side) return;
    place.replaceChildren(h("p", { class: "sub" }, "Being worked out; go on meanwhile …"));
    side.derived.prices(decision).then(
      (prices) => place.replaceChildren(told(prices, goal, besideOf(side, decision, goal))),
      (error: Error) => place.replaceChildren(h("p", { class: "sub" }, `It could not be worked out: ${error.message}`), h("button", { type: "button", onclick: () => this.ask(place, goal, decision) }, "Again")),
    );
  }
}

/** What the decision said of the goal, and the plan it chose. */
const besideOf = ({ run }: Side, decision: number, goal: number): Beside | undefined => {
  const index = run?.moments.findIndex(({ number }) => number === decision) ?? -1;
  const [moment, verdict] = [run?.moment(index), run?.verdict(index, goal)];
  const chosen = moment?.family[moment.chosen];
  return verdict && chosen ? { reason: verdict.reason, value: chosen.value, reliability: chosen.reliability } : undefined;
};

const told = (prices: Prices | undefined, goal: number, beside: Beside | undefined): HTMLElement => {
  if (!prices) return h("p", { class: "sub" }, `The prices of this decision are not in this page; whoever sends it puts them in by ${PUT_IN}`);
  const tag = prices.tags.find((one) => one.goal === goalName(goal));
  return tag ? priceList(tag, prices.limits, beside) : h("p", { class: "sub" }, "It was not among the goals left out that have a price.");
};
