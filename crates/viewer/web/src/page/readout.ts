// Every value at the cell asked about.

import { at } from "../model/plane";
import type { Cell } from "../model/types";
import type { Planes } from "../planes";
import type { View } from "../state";
import { h } from "../ui/dom";
import { goalName, place, plain } from "../ui/format";
import type { Sides } from "./side";

export class Readout {
  readonly element = h("div", { class: "readout" });

  constructor(private readonly sides: Sides) {}

  show(view: View): void {
    const { run, planes } = this.sides.a ?? {};
    const { probe } = view;
    const moment = run?.moment(view.index);
    if (!run || !planes || !moment || !probe) {
      this.element.replaceChildren();
      return;
    }
    const { grid } = run.facts;
    const [east, north] = [grid.westM + (probe.col + 0.5) * grid.spacingM, grid.northM - (probe.row + 0.5) * grid.spacingM];
    const goals = [...run.verdictsUpTo(view.index).values()].filter(({ verdict }) => verdict.goal.target.row === probe.row && verdict.goal.target.col === probe.col);
    const lines = run.planes.map(({ id, label }) => {
      const value = h("dd", {}, "…");
      // Each as it comes: some layers are put together from many looks first.
      valueAt(planes, id, moment.number, probe).then(
        (found) => (value.textContent = found === undefined ? "unknown" : plain(found)),
        () => (value.textContent = "not readable"),
      );
      return h("div", { class: id === view.layer ? "on" : "" }, h("dt", {}, label), value);
    });
    this.element.replaceChildren(
      h("p", {}, h("b", {}, `cell ${place(probe)}`), ` ${east.toFixed(1)} m east, ${north.toFixed(1)} m north`),
      h("dl", {}, lines),
      ...goals.map(({ verdict }) => h("p", {}, `${goalName(verdict.goal.id)} ${verdict.goal.directive}: ${verdict.action}, ${verdict.reason}`)),
    );
  }
}

const valueAt = async (planes: Planes, id: string, decision: number, cell: Cell): Promise<number | undefined> => {
  const plane = await planes.at(id, decision);
  return plane && at(plane, cell);
};
