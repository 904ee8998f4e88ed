// A run as far as it was read.

import type { Batch } from "../read/protocol";
import type { Cell, Happening, Look, Moment, Outcome, PlaneName, RunFacts, TextLine, TopicCount, Verdict, Wholeness } from "./types";

export class Run {
  readonly moments: Moment[] = [];
  readonly outcomes = new Map<number, Outcome>();
  readonly looks: Look[] = [];
  readonly happenings: Happening[] = [];
  readonly lines: TextLine[] = [];
  planes: PlaneName[] = [];
  topics: TopicCount[] = [];
  wholeness: Wholeness = { kind: "reading" };
  end: Record<string, string> = {};
  readBytes = 0;
  private said: { index: number; all: Map<number, { verdict: Verdict; index: number }> } | undefined;

  constructor(readonly facts: RunFacts) {}

  add(batch: Batch): void {
    this.moments.push(...batch.moments);
    for (const outcome of batch.outcomes) this.outcomes.set(outcome.decision, outcome);
    this.looks.push(...batch.looks);
    this.happenings.push(...batch.happenings);
    this.lines.push(...batch.lines);
  }

  /** The moment at this place of the run, from 0. */
  moment(index: number): Moment | undefined {
    return this.moments[index];
  }

  /** Mission time at which the log ends. */
  get endS(): number {
    const last = this.moments.at(-1);
    const outcome = last && this.outcomes.get(last.number);
    return Math.max(last?.timeS ?? 0, outcome?.spent.timeS ?? 0, this.looks.at(-1)?.timeS ?? 0);
  }

  /** The latest moment at or before a time. */
  indexAt(timeS: number): number {
    let [from, to] = [0, this.moments.length];
    // Halved until `from` is the first moment after.
    while (from < to) {
      const middle = (from + to) >> 1;
      if ((this.moments[middle]?.timeS ?? 0) > timeS) to = middle;
      else from = middle + 1;
    }
    return Math.max(0, from - 1);
  }

  /** Cells driven before a decision, one list a drive. */
  tracks(index: number): Cell[][] {
    return this.moments.slice(0, index).flatMap((moment) => {
      const track = this.outcomes.get(moment.number)?.track ?? [];
      return track.length > 1 ? [track] : [];
    });
  }

  /** What was said last of every goal known by a decision, ended ones included. */
  verdictsUpTo(index: number): ReadonlyMap<number, { verdict: Verdict; index: number }> {
    // Asked for at every frame of a pan.
    if (this.said?.index === index) return this.said.all;
    const said = new Map<number, { verdict: Verdict; index: number }>();
    for (let i = 0; i <= index; i++) {
      for (const verdict of this.moments[i]?.verdicts ?? []) said.set(verdict.goal.id, { verdict, index: i });
    }
    this.said = { index, all: said };
    return said;
  }
}
