// What the page and its reader say to each other.

import type { Plane } from "../model/plane";
import type { Relief } from "../view/relief";
import type { Checks, Happening, Look, Moment, Outcome, PlaneName, RunFacts, TextLine, TopicCount, Wholeness } from "../model/types";

/** Where a log comes from. */
export type Origin =
  | { kind: "blob"; name: string; blob: Blob }
  | { kind: "url"; name: string; url: string }
  | { kind: "base64"; name: string; text: string };

/** From the page. */
export type Ask =
  | { kind: "open"; origin: Origin }
  | { kind: "plane"; ticket: number; plane: string; decision: number }
  | { kind: "relief"; ticket: number; plane: string; decision: number }
  | { kind: "attachment"; ticket: number; name: string };

/** What was found since the last word. */
export interface Batch {
  moments: Moment[];
  outcomes: Outcome[];
  looks: Look[];
  happenings: Happening[];
  lines: TextLine[];
}

/** From the reader. */
export type Tell =
  | { kind: "facts"; facts: RunFacts }
  | { kind: "batch"; batch: Batch; planes: PlaneName[]; readBytes: number }
  | { kind: "end"; wholeness: Wholeness; run: Record<string, string>; topics: TopicCount[]; planes: PlaneName[]; checks: Checks }
  | { kind: "plane"; ticket: number; plane: Plane | undefined }
  | { kind: "relief"; ticket: number; relief: Relief | undefined }
  | { kind: "attachment"; ticket: number; bytes: Uint8Array<ArrayBuffer> | undefined }
  | { kind: "failed"; ticket?: number; text: string };
