// Where moments lie from left to right: by mission time, or by the number of the decision. Two runs share one scale.

import type { Run } from "../model/run";
import type { Axis } from "../state";
import { clock } from "../ui/format";

/** Steps of an axis of hours and minutes, seconds. */
const STEPS_S = [60, 120, 300, 600, 900, 1800, 3600, 7200, 14_400, 21_600, 43_200, 86_400, 172_800, 432_000, 864_000] as const;
const TIME_TICK_PX = 74;
const NUMBER_TICK_PX = 30;

export class TimeScale {
  private readonly count: number;
  private readonly endS: number;

  constructor(
    private readonly runs: readonly Run[],
    private readonly axis: Axis,
    private readonly left: number,
    private readonly width: number,
  ) {
    this.count = Math.max(1, ...runs.map(({ moments }) => moments.length));
    this.endS = Math.max(1, ...runs.map((run) => run.endS));
  }

  /** Where a decision of a run begins; the one after the last is where its log ends. */
  x(run: Run, index: number): number {
    if (this.axis === "decision") return this.left + (this.width * index) / this.count;
    return this.at((run.moments[index]?.timeS ?? run.endS) / this.endS);
  }

  /** Where a mission time of a run lies; between decisions, in proportion. */
  xOf(run: Run, timeS: number): number {
    if (this.axis === "time") return this.at(timeS / this.endS);
    const index = run.indexAt(timeS);
    const [from, to] = [run.moments[index]?.timeS ?? 0, run.moments[index + 1]?.timeS ?? run.endS];
    const part = to > from ? Math.min(1, (timeS - from) / (to - from)) : 0;
    return this.x(run, index + part);
  }

  /** The decision of a run that lies nearest to a pixel. */
  indexAt(run: Run, px: number): number {
    const part = (px - this.left) / Math.max(1, this.width);
    const last = Math.max(0, run.moments.length - 1);
    const within = (index: number): number => Math.max(0, Math.min(last, index));
    if (this.axis === "decision") return within(Math.round(part * this.count));
    const before = run.indexAt(part * this.endS);
    return this.x(run, before + 1) - px < px - this.x(run, before) ? within(before + 1) : before;
  }

  ticks(): { x: number; words: string }[] {
    if (this.axis === "time") {
      const most = Math.max(2, this.width / TIME_TICK_PX);
      const step = STEPS_S.find((one) => this.endS / one <= most) ?? this.endS / most;
      return Array.from({ length: Math.floor(this.endS / step) + 1 }, (_, i) => ({ x: this.at((i * step) / this.endS), words: clock(i * step).replace(" h", "") }));
    }
    const numbered = this.runs.reduce<Run | undefined>((longest, run) => (longest && longest.moments.length >= run.moments.length ? longest : run), undefined);
    const step = Math.max(1, Math.ceil((this.count * NUMBER_TICK_PX) / Math.max(1, this.width)));
    return Array.from({ length: Math.ceil(this.count / step) }, (_, i) => ({
      x: this.left + (this.width * i * step) / this.count,
      words: String(numbered?.moments[i * step]?.number ?? i * step),
    }));
  }

  private at(part: number): number {
    return this.left + this.width * part;
  }
}
