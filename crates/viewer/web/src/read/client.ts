// The page's side of the reader.

import type { Plane } from "../model/plane";
import type { Relief } from "../view/relief";
import type { Ask, Origin, Tell } from "./protocol";
import ReaderThread from "./worker?worker&inline";

export class LogClient {
  private readonly thread = new ReaderThread();
  private readonly waiting = new Map<number, { resolve: (value: unknown) => void; reject: (why: Error) => void }>();
  private tickets = 0;

  constructor(private readonly heard: (tell: Tell) => void) {
    this.thread.onmessage = ({ data }: MessageEvent<Tell>) => this.hear(data);
    this.thread.onerror = (event: ErrorEvent) => heard({ kind: "failed", text: event.message });
  }

  open(origin: Origin): void {
    this.ask({ kind: "open", origin });
  }

  plane(plane: string, decision: number): Promise<Plane | undefined> {
    return this.request((ticket) => ({ kind: "plane", ticket, plane, decision })) as Promise<Plane | undefined>;
  }

  relief(plane: string, decision: number): Promise<Relief | undefined> {
    return this.request((ticket) => ({ kind: "relief", ticket, plane, decision })) as Promise<Relief | undefined>;
  }

  attachment(name: string): Promise<Uint8Array<ArrayBuffer> | undefined> {
    return this.request((ticket) => ({ kind: "attachment", ticket, name })) as Promise<Uint8Array<ArrayBuffer> | undefined>;
  }

  close(): void {
    this.thread.terminate();
  }

  private ask(ask: Ask): void {
    this.thread.postMessage(ask);
  }

  private request(ask: (ticket: number) => Ask): Promise<unknown> {
    const ticket = ++this.tickets;
    this.ask(ask(ticket));
    return new Promise((resolve, reject) => this.waiting.set(ticket, { resolve, reject }));
  }

  private hear(tell: Tell): void {
    if (tell.kind === "failed" && tell.ticket !== undefined) {
      this.waiting.get(tell.ticket)?.reject(new Error(tell.text));
      this.waiting.delete(tell.ticket);
    } else if (tell.kind === "plane" || tell.kind === "relief" || tell.kind === "attachment") {
      const found = tell.kind === "plane" ? tell.plane : tell.kind === "relief" ? tell.relief : tell.bytes;
      this.waiting.get(tell.ticket)?.resolve(found);
      this.waiting.delete(tell.ticket);
    } else {
      this.heard(tell);
    }
  }
}
