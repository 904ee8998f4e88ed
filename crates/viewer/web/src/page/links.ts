// Links to a moment: followed as the logs come in, written as one goes, and copied.

import type { Store } from "../state";
import { Address, written } from "./address";
import type { Layers } from "./layers";
import { apart } from "./side";
import { leadOf } from "./lead";
import type { Sides } from "./side";

export class Links {
  private readonly address = new Address(() => this.follow());
  /** Whether the address said what is shown beside the map. */
  tab = false;
  private followed = false;

  constructor(
    private readonly store: Store,
    private readonly sides: Sides,
    private readonly layers: Layers,
    private readonly seek: (index: number) => void,
  ) {}

  /** Shows what the address asks for, as far as it is there by now. */
  follow(): void {
    const { a, b } = this.sides;
    if (!a?.run) return;
    // Layers that are derived become known late, and what is of two runs only with the second.
    const ended = a.run.wholeness.kind !== "reading" && a.derivable !== undefined && (!b || b.run?.wholeness.kind !== "reading");
    const wanted = this.address.subject ?? this.store.view.subject;
    const run = wanted === "b" && b ? b.run : a.run;
    if (!run) return;
    const { index, view } = this.address.found(run, this.layers.choices.map(({ id }) => id), ended);
    if (view) {
      this.tab = view.tab !== "goals" || view.subject === "b";
      // An address that names no page leaves that of a second log, which may have been read to its end before.
      const tab = !this.followed && !this.tab && b?.run && this.store.view.tab === "other" ? "other" : view.tab;
      this.followed = true;
      const aspect = view.aspect === "between" && (!b || apart(this.sides)) ? "value" : view.aspect;
      this.store.set({ ...view, tab, aspect, ...(b ? {} : { subject: "a" as const }) });
    }
    if (index !== undefined) this.seek(index);
  }

  write(): void {
    const { decision } = this;
    if (decision !== undefined) this.address.write(decision, this.store.view);
  }

  /** The address of what is looked at, to be sent to somebody else. Returns what came of it. */
  async copy(): Promise<string> {
    const { decision } = this;
    if (decision === undefined) return "There is no moment to link to.";
    const link = new URL(written(decision, this.store.view), location.href).href;
    try {
      await navigator.clipboard.writeText(link);
      return "The link to this moment is copied.";
    } catch {
      return `The browser does not let the link be copied; it is ${link}`;
    }
  }

  private get decision(): number | undefined {
    return leadOf(this.sides, this.store.view)?.run?.moment(this.store.view.index)?.number;
  }
}
