// Planes that came inside the page, in a log of their own beside the run's.

import type { Plane } from "../model/plane";
import { LogClient } from "../read/client";
import type { Origin, Tell } from "../read/protocol";
import type { PlaneSource } from "./source";

export class PlanesInside implements PlaneSource {
  private client: LogClient | undefined;
  private fault = "";
  private readonly ended: Promise<void>;
  private end: () => void = () => undefined;
  /** Planes of the decision asked about last: a cell is asked about in all of them, and then the next one. */
  private kept = { decision: -1, planes: new Map<string, Promise<Plane | undefined>>() };

  constructor(private readonly origin: Origin) {
    this.ended = new Promise((resolve) => (this.end = resolve));
  }

  /** A plane at a decision. They are read when the first is asked for: of most pages nobody wants any. */
  at(name: string, decision: number): Promise<Plane | undefined> {
    if (this.kept.decision !== decision) this.kept = { decision, planes: new Map() };
    const { planes } = this.kept;
    const known = planes.get(name);
    if (known) return known;
    const found = this.read(name, decision);
    planes.set(name, found);
    found.catch(() => planes.delete(name));
    return found;
  }

  close(): void {
    this.client?.close();
  }

  private async read(name: string, decision: number): Promise<Plane | undefined> {
    this.client ??= this.opened();
    await this.ended;
    const plane = await this.client.plane(`map:${name}`, decision);
    if (!plane && this.fault) throw new Error(`the planes in this page: ${this.fault}`);
    return plane;
  }

  private opened(): LogClient {
    const client = new LogClient((tell) => this.hear(tell));
    client.open(this.origin);
    return client;
  }

  private hear(tell: Tell): void {
    if (tell.kind === "failed") this.fault = tell.text;
    // There is no run in it that could have been left unfinished.
    if (tell.kind === "end" && (tell.wholeness.kind === "cut" || tell.wholeness.kind === "damaged")) this.fault = tell.wholeness.text;
    if (tell.kind === "failed" || tell.kind === "end") this.end();
  }
}
