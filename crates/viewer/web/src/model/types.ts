// What the viewer knows of a run: plain records, cut down from the log's own to what is shown.
//
// Names follow the log (see docs/log-format.md); units end the names; cells count from the north-west.

export interface Cell {
  readonly row: number;
  readonly col: number;
}

/** Totals since the mission began. */
export interface Spent {
  timeS: number;
  energyJ: number;
  dataMb: number;
  lengthM: number;
}

/** The grid of the run. */
export interface GridSpec {
  rows: number;
  cols: number;
  spacingM: number;
  westM: number;
  northM: number;
}

/** A number that was compared, and what with. */
export interface Term {
  name: string;
  value?: number;
  limit?: number;
}

/** Why a decision was due. */
export interface Trigger {
  name: string;
  goal?: number;
  cell?: Cell;
  /** The numbers that the trigger speaks of, by their names in the log. */
  numbers: { name: string; value: number }[];
}

/** A goal as it stood after a decision. */
export interface Goal {
  id: number;
  directive: string;
  kind: string;
  target: Cell;
  interest: number;
  prize: number;
  prominence: number;
  ignorance: number;
  paradox: number;
  contradiction: number;
  /** Share of each expert, in the order of the mission. */
  credit: number[];
  regionCells: number;
  attempts: number;
  born: number;
  status: string;
  parent?: number;
  commanded: boolean;
}

/** What changed about a goal itself. */
export interface Change {
  transformation: string;
  reason: string;
  other?: number;
  terms: Term[];
}

/** A step in a goal's life. */
export interface Step {
  from: string;
  to: string;
  reason: string;
  outcome?: string;
}

/** What a decision said of one goal. */
export interface Verdict {
  goal: Goal;
  action: string;
  reason: string;
  cause: string;
  turn?: number;
  other?: number;
  terms: Term[];
  transformation: string;
  changes: Change[];
  steps: Step[];
}

/** One leg of the chosen plan and what is done at its end. */
export interface Leg {
  goal: number;
  operators: string[];
  pose: Cell;
  cells: Cell[];
  lengthM: number;
  timeS: number;
  energyJ: number;
  /** Chance to arrive at the end of this leg, once it begins. */
  reliability: number;
  /** Chance to get this far. */
  reliabilitySoFar: number;
}

/** A member of the plan family. */
export interface PlanOption {
  /** Goals in their order. */
  order: number[];
  /** Where each leg ends. The log keeps only digests of the ways between. */
  poses: Cell[];
  value: number;
  prize: number;
  expected: number;
  reliability: number;
  timeS: number;
  energyJ: number;
  dataMb: number;
  lengthM: number;
  frontBest: number;
  frontPlans: number;
  objectives: { name: string; value: number }[];
}

/** What the rover was told to do. */
export interface Act {
  name: string;
  goal?: number;
  route: Cell[];
  wake?: string;
  ignorance?: number;
  lengthM: number;
  timeS: number;
  energyJ: number;
  reliability: number;
}

/** One decision. */
export interface Moment {
  number: number;
  decisionVersion: number;
  timeS: number;
  triggers: Trigger[];
  pose: Cell;
  headingRad: number;
  spent: Spent;
  facts: string[];
  underway?: number;
  seen: number;
  mapChanged: boolean;
  background: number;
  sites: number;
  shortlist: number;
  proof: string;
  bound?: number;
  held: boolean;
  expansions: number;
  family: PlanOption[];
  chosen: number;
  act: Act;
  legs: Leg[];
  verdicts: Verdict[];
  chain: string;
}

/** What came of a decision's step. */
export interface Outcome {
  decision: number;
  result: string;
  goal?: number;
  operators: string[];
  pose: Cell;
  spent: Spent;
  predicted: number;
  track: Cell[];
}

/** What was read in one look, without the readings. */
export interface Look {
  number: number;
  /** The decision that could first use it. */
  decision: number;
  timeS: number;
  pose: Cell;
  windows: { layer: string; row: number; col: number; rows: number; cols: number }[];
}

/** Word from outside, or something that broke. */
export interface Happening {
  kind: "message" | "fault";
  name: string;
  timeS: number;
  /** The next decision to be taken. */
  decision: number;
  text: string;
}

/** A line of the text log. */
export interface TextLine {
  decision: number;
  timeS: number;
  level: number;
  text: string;
}

/** What is in the file on one topic. */
export interface TopicCount {
  topic: string;
  schema: string;
  count: number;
  bytes: number;
  /** Whether the viewer reads it. */
  known: boolean;
  /** Messages that could not be decoded, and why the first could not. */
  unread: number;
  why: string;
}

/** What the file's envelope says. */
export interface RunFacts {
  name: string;
  bytes: number;
  run: Record<string, string>;
  grid: GridSpec;
  attachments: { name: string; bytes: number }[];
  /** The experts' names, in the order of the credits. */
  experts: string[];
  /** Goals of one directive nearer than this are of one place. */
  identityRadiusM: number;
  /** By what share a new plan must be better than the committed one; not known without the mission's file. */
  hysteresis: number | undefined;
  /** Each directive's factor on the prize. */
  weights: ReadonlyMap<string, number>;
}

/** How whole the file is. */
export type Wholeness =
  | { kind: "reading" }
  | { kind: "whole" }
  | { kind: "unfinished"; text: string }
  | { kind: "cut"; at: number; text: string }
  | { kind: "damaged"; at: number; text: string };

/** How one CRC came out: `absent` if the file has none, `unread` if reading did not get there. */
export type CrcCheck = "right" | "wrong" | "absent" | "unread";

/** What was held against its CRC while a file was read. */
export interface Checks {
  /** By the file's index, or record by record from the front. */
  way: "index" | "front";
  chunks: number;
  /** How many of them carry a CRC; a chunk that fails it is not counted as read. */
  chunkCrcs: number;
  attachments: number;
  attachmentsWrong: number;
  summary: CrcCheck;
  data: CrcCheck;
}

/** A plane that can be asked for. */
export interface PlaneName {
  /** `map:interest`, `read:temperature`, `doubt:temperature`. */
  id: string;
  label: string;
  unit?: string;
  /** What its values stand for, where they are names and no amounts. */
  classes?: PlaneClass[];
}

export interface PlaneClass {
  value: number;
  name: string;
}
