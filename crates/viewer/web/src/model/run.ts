// A run as far as it was read.

import type { Batch } from "../read/protocol";
import { Lives } from "./lives";
import type { Cell, Checks, Happening, Look, Moment, Outcome, PlaneName, RunFacts, TextLine, TopicCount, Verdict, Wholeness } from "./types";

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
  /** What was held against its CRC; there once the file was read. */
  checks: Checks | undefined;
  readBytes = 0;
  readonly lives = new Lives();
  private said: { index: number; of: number; all: Map<number, { verdict: Verdict; index: number }> } | undefined;
  private driven: { index: number; of: number; tracks: Cell[][] } | undefined;
  private readonly byGoal = new WeakMap<Moment, Map<number, Verdict>>();

  constructor(readonly facts: RunFacts) {}

  add(batch: Batch): void {
    this.moments.push(...batch.moments);
    this.lives.take(this.moments);
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
    // Asked for at every frame of a pan.
    if (this.driven?.index === index && this.driven.of === this.outcomes.size) return this.driven.tracks;
    const tracks = this.moments.slice(0, index).flatMap((moment) => {
      const track = this.outcomes.get(moment.number)?.track ?? [];
      return track.length > 1 ? [track] : [];
    });
    this.driven = { index, of: this.outcomes.size, tracks };
    return tracks;
  }

  /** What a decision said of a goal. */
  verdict(index: number, goal: number): Verdict | undefined {
    const moment = this.moments[index];
    if (!moment) return undefined;
    let known = this.byGoal.get(moment);
    if (!known) {
      known = new Map(moment.verdicts.map((verdict) => [verdict.goal.id, verdict]));
      this.byGoal.set(moment, known);
    }
    return known.get(goal);
  }

  /** What was said last of every goal known by a decision, ended ones included. */
  verdictsUpTo(index: number): ReadonlyMap<number, { verdict: Verdict; index: number }> {
    if (this.said?.index === index && this.said.of === this.moments.length) return this.said.all;
    const said = new Map<number, { verdict: Verdict; index: number }>();
    for (const { goal, first, last } of this.lives.all()) {
      for (let i = Math.min(index, last); i >= first; i--) {
        const verdict = this.verdict(i, goal);
        if (!verdict) continue;
        said.set(goal, { verdict, index: i });
        break;
      }
    }
    this.said = { index, of: this.moments.length, all: said };
    return said;
  }
}
