// The reader's thread: keeps decoding away from the page.

import { LogReader } from "./log";
import type { Ask, Origin, Tell } from "./protocol";
import { BlobSource, RangeSource } from "./source";
import type { Source } from "./source";

const tell = (word: Tell): void => self.postMessage(word);

const sourceOf = (origin: Origin): Source => {
  switch (origin.kind) {
    case "blob":
      return new BlobSource(origin.name, origin.blob);
    case "url":
      return new RangeSource(origin.name, origin.url);
    case "base64":
      return new BlobSource(origin.name, new Blob(decoded(origin.text)));
  }
};

/** Bytes of base64, piece by piece: one long string would be held three times over. */
function* pieces(text: string): Generator<Uint8Array<ArrayBuffer>, void, void> {
  const dense = text.replace(/\s+/g, "");
  const step = 4 * 65_536;
  for (let from = 0; from < dense.length; from += step) {
    const raw = atob(dense.slice(from, from + step));
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    yield bytes;
  }
}
const decoded = (text: string): Uint8Array<ArrayBuffer>[] => [...pieces(text)];

let reader: LogReader | undefined;
/** Planes are asked for one by one: readings of a layer are put together in order. */
let queue: Promise<void> = Promise.resolve();

const answer = async (ask: Ask): Promise<void> => {
  if (ask.kind === "open") {
    reader = new LogReader(sourceOf(ask.origin), tell);
    await reader.read();
  } else if (ask.kind === "plane") {
    tell({ kind: "plane", ticket: ask.ticket, plane: await reader?.plane(ask.plane, ask.decision) });
  } else if (ask.kind === "relief") {
    tell({ kind: "relief", ticket: ask.ticket, relief: await reader?.relief(ask.plane, ask.decision) });
  } else {
    tell({ kind: "attachment", ticket: ask.ticket, bytes: reader?.attachment(ask.name)?.slice() });
  }
};

self.onmessage = ({ data: ask }: MessageEvent<Ask>): void => {
  const failed = (error: unknown): void =>
    tell({ kind: "failed", ticket: ask.kind === "open" ? undefined : ask.ticket, text: error instanceof Error ? error.message : String(error) });
  // Opening takes long and must not hold up the planes of what is there already.
  if (ask.kind === "open") answer(ask).catch(failed);
  else queue = queue.then(() => answer(ask)).catch(failed);
};
