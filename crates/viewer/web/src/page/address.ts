// The moment in the page's address: #d=7 is decision 7.

import type { Run } from "../model/run";

export class Address {
  /** The decision that the address asks for, until it was read. */
  private wanted: number | undefined;

  constructor(changed: () => void) {
    this.read();
    window.addEventListener("hashchange", () => {
      this.read();
      changed();
    });
  }

  /** The place in the run that the address asks for, told once. */
  found(run: Run): number | undefined {
    if (this.wanted === undefined) return undefined;
    const index = run.moments.findIndex((moment) => moment.number === this.wanted);
    if (index < 0) return undefined;
    this.wanted = undefined;
    return index;
  }

  write(decision: number): void {
    if (this.wanted !== undefined) return;
    if (location.hash !== `#d=${decision}`) history.replaceState(null, "", `#d=${decision}`);
  }

  private read(): void {
    const found = /(?:^#|&)d=(\d+)/.exec(location.hash)?.[1];
    this.wanted = found === undefined ? undefined : Number(found);
  }
}
