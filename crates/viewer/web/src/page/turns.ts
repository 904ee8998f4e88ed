// One at a time: who asks for one thing after another gets the last of them, and nobody waits for those between.

export class Turns {
  /** What is under way, and whether it was asked for again since. */
  private readonly underWay = new Map<string, { again: boolean }>();

  /**
   * Does something, unless it is being done: then it is done once more at the end. It says whether it came in time; if
   * not, it is done again too.
   */
  async take(what: string, does: () => Promise<boolean>): Promise<void> {
    const before = this.underWay.get(what);
    if (before) {
      before.again = true;
      return;
    }
    const now = { again: false };
    this.underWay.set(what, now);
    try {
      for (let done = false; !done; ) {
        now.again = false;
        done = (await does()) && !now.again;
      }
    } finally {
      this.underWay.delete(what);
    }
  }
}
