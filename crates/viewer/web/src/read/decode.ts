// From the log's own records to what is shown, by reflection over the descriptors in the file.
//
// Old logs lack fields that newer ones have, and newer ones may have what this page does not know: so nothing is
// taken for granted, and every field has a value for its absence.

import { createFileRegistry, fromBinary } from "@bufbuild/protobuf";
import type { DescMessage } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";

import type * as model from "../model/types";
import type { Schema } from "./container";

/** A decoded message: fields by name, unknown until asked for. */
export interface Fields {
  readonly [name: string]: unknown;
}

const NOTHING: Fields = Object.freeze({});

export const num = (of: Fields, name: string): number => {
  const value = of[name];
  return typeof value === "number" ? value : typeof value === "bigint" ? Number(value) : 0;
};
export const maybe = (of: Fields, name: string): number | undefined => {
  const value = of[name];
  return typeof value === "number" ? value : typeof value === "bigint" ? Number(value) : undefined;
};
export const str = (of: Fields, name: string): string => (typeof of[name] === "string" ? of[name] : "");
const maybeStr = (of: Fields, name: string): string | undefined =>
  typeof of[name] === "string" ? of[name] : undefined;
const flag = (of: Fields, name: string): boolean => of[name] === true;
export const sub = (of: Fields, name: string): Fields => (of[name] as Fields | undefined) ?? NOTHING;
export const list = (of: Fields, name: string): Fields[] => (of[name] as Fields[] | undefined) ?? [];
const numbers = (of: Fields, name: string): number[] => ((of[name] as number[] | undefined) ?? []).map(Number);
const strings = (of: Fields, name: string): string[] => (of[name] as string[] | undefined) ?? [];

/** Decodes the messages of one schema. */
export class Decoder {
  private constructor(private readonly descriptor: DescMessage) {}

  /** Without the fields named, if any (`LayerWindow.values`): the decoder then skips them. */
  static of(schema: Schema, without: readonly string[] = []): Decoder {
    const files = fromBinary(FileDescriptorSetSchema, schema.data);
    for (const message of files.file.flatMap((file) => file.messageType)) {
      message.field = message.field.filter((field) => !without.includes(`${message.name}.${field.name}`));
    }
    const descriptor = createFileRegistry(files).getMessage(schema.name);
    if (!descriptor) throw new Error(`schema ${schema.name} does not describe itself`);
    return new Decoder(descriptor);
  }

  decode(bytes: Uint8Array): Fields {
    return fromBinary(this.descriptor, bytes, { readUnknownFields: false }) as unknown as Fields;
  }
}

export const cell = (of: Fields): model.Cell => ({ row: num(of, "row"), col: num(of, "col") });
const maybeCell = (of: unknown): model.Cell | undefined => (of ? cell(of as Fields) : undefined);

const spent = (of: Fields): model.Spent => ({
  timeS: num(of, "timeS"),
  energyJ: num(of, "energyJ"),
  dataMb: num(of, "dataMb"),
  lengthM: num(of, "lengthM"),
});

/** Absent is infinite: no chance. */
const chance = (cost: Fields): number => {
  const negLnR = maybe(cost, "negLnR");
  return negLnR === undefined ? 0 : Math.exp(-negLnR);
};

const terms = (of: Fields): model.Term[] =>
  list(of, "terms").map((term) => ({
    name: str(term, "name"),
    value: maybe(term, "value"),
    limit: maybe(term, "limit"),
  }));

const TRIGGER_NUMBERS = ["before", "after", "prize", "share", "reliability", "floor", "seconds", "message"];

const trigger = (of: Fields): model.Trigger => ({
  name: str(of, "name"),
  goal: maybe(of, "goal"),
  cell: maybeCell(of.cell),
  numbers: TRIGGER_NUMBERS.flatMap((name) => {
    const value = maybe(of, name);
    return value === undefined ? [] : [{ name, value }];
  }),
});

const goal = (of: Fields): model.Goal => ({
  id: num(of, "id"),
  directive: str(of, "directiveName"),
  kind: str(of, "kind") || "inspect",
  target: cell(sub(of, "target")),
  interest: num(of, "interest"),
  prize: num(of, "prize"),
  prominence: num(of, "prominence"),
  ignorance: num(of, "ignorance"),
  paradox: num(of, "paradox"),
  contradiction: num(of, "contradiction"),
  credit: numbers(of, "credit"),
  regionCells: num(of, "regionCells"),
  attempts: num(of, "attempts"),
  born: num(of, "born"),
  status: str(of, "status"),
  parent: maybe(of, "parent"),
  commanded: of.order !== undefined,
});

const OBJECTIVES: readonly [string, string][] = [
  ["expectedInterest", "expected-interest"],
  ["mostInteresting", "most-interesting"],
  ["allOrNothing", "all-or-nothing"],
  ["chanceConstrained", "chance-constrained"],
  ["netBenefit", "net-benefit"],
  ["utility", "utility"],
];

const option = (of: Fields): model.PlanOption => {
  const sequence = sub(of, "sequence");
  const objectives = sub(of, "objectives");
  return {
    order: list(sequence, "stops").map((stop) => num(stop, "goal")),
    poses: list(of, "legs").map((leg) => cell(sub(leg, "pose"))),
    value: num(sequence, "value"),
    prize: num(sequence, "prize"),
    expected: num(sequence, "expected"),
    reliability: num(sequence, "reliability"),
    timeS: num(sequence, "timeS"),
    energyJ: num(sequence, "energyJ"),
    dataMb: num(sequence, "dataMb"),
    lengthM: num(sub(of, "total"), "lengthM"),
    frontBest: num(of, "frontBest"),
    frontPlans: num(of, "frontPlans"),
    objectives: OBJECTIVES.flatMap(([field, name]) => {
      const value = maybe(objectives, field);
      return value === undefined ? [] : [{ name, value }];
    }),
  };
};

const legs = (choice: Fields, chosen: Fields): model.Leg[] => {
  const stops = list(sub(chosen, "sequence"), "stops");
  let soFar = 1;
  return list(sub(choice, "plan"), "legs").map((leg, turn) => {
    const stop = stops[num(leg, "stop")] ?? stops[turn] ?? NOTHING;
    const route = sub(leg, "route");
    const cost = sub(route, "cost");
    const service = sub(leg, "service");
    const reliability = chance(cost);
    soFar *= reliability;
    return {
      goal: num(stop, "goal"),
      operators: [...strings(stop, "before"), "drive", ...strings(stop, "after")],
      pose: cell(sub(leg, "pose")),
      cells: list(route, "cells").map(cell),
      lengthM: num(cost, "lengthM"),
      timeS: num(cost, "timeS") + num(service, "timeS"),
      energyJ: num(cost, "energyJ") + num(service, "energyJ"),
      reliability,
      reliabilitySoFar: soFar,
    };
  });
};

const act = (of: Fields): model.Act => {
  const cost = sub(of, "cost");
  return {
    name: str(of, "name"),
    goal: maybe(of, "goal"),
    route: list(sub(of, "route"), "cells").map(cell),
    wake: maybeStr(of, "wake"),
    ignorance: maybe(of, "ignorance"),
    lengthM: num(cost, "lengthM"),
    timeS: num(cost, "timeS"),
    energyJ: num(cost, "energyJ"),
    reliability: chance(cost),
  };
};

const verdicts = (choice: Fields): model.Verdict[] => {
  const steps = new Map<number, model.Step[]>();
  for (const step of list(choice, "transitions")) {
    const of = num(step, "goal");
    const taken = steps.get(of) ?? [];
    steps.set(of, taken);
    taken.push({
      from: str(step, "from"),
      to: str(step, "to"),
      reason: str(step, "reason"),
      outcome: maybeStr(step, "outcome"),
    });
  }
  return list(choice, "verdicts").map((of) => ({
    goal: goal(sub(of, "goal")),
    action: str(of, "action"),
    reason: str(of, "reason"),
    cause: str(of, "cause"),
    turn: maybe(of, "turn"),
    other: maybe(of, "other"),
    terms: terms(of),
    transformation: str(of, "transformation"),
    changes: list(of, "changes").map((change) => ({
      transformation: str(change, "transformation"),
      reason: str(change, "reason"),
      other: maybe(change, "other"),
      terms: terms(change),
    })),
    steps: steps.get(num(sub(of, "goal"), "id")) ?? [],
  }));
};

/** A decision, without the manager's memory: that is twice the size of all else, and not shown. */
export const moment = (of: Fields): model.Moment => {
  const state = sub(of, "state");
  const pose = sub(state, "pose");
  const frame = sub(of, "frame");
  const candidates = sub(of, "candidates");
  const objective = sub(of, "objective");
  const choice = sub(of, "choice");
  const family = list(objective, "family");
  const chosen = num(choice, "chosen");
  return {
    number: num(of, "number"),
    decisionVersion: num(of, "decisionVersion"),
    timeS: num(sub(state, "spent"), "timeS"),
    triggers: list(of, "triggers").map(trigger),
    pose: cell(sub(pose, "cell")),
    headingRad: num(pose, "headingRad"),
    spent: spent(sub(state, "spent")),
    facts: strings(state, "facts"),
    underway: maybe(state, "underway"),
    seen: num(frame, "seen"),
    mapChanged: flag(frame, "mapChanged"),
    background: num(sub(of, "fusion"), "background"),
    sites: list(candidates, "sites").length,
    shortlist: ((candidates.shortlist as unknown[] | undefined) ?? []).length,
    proof: str(objective, "proof"),
    bound: maybe(objective, "bound"),
    held: flag(objective, "held"),
    expansions: num(objective, "expansions"),
    family: family.map(option),
    chosen,
    act: act(sub(choice, "act")),
    legs: legs(choice, family[chosen] ?? NOTHING),
    verdicts: verdicts(choice),
    chain: str(of, "chain"),
  };
};

export const outcome = (of: Fields): model.Outcome => ({
  decision: num(of, "decision"),
  result: str(of, "result"),
  goal: maybe(of, "goal"),
  operators: strings(of, "operators"),
  pose: cell(sub(sub(of, "pose"), "cell")),
  spent: spent(sub(of, "spent")),
  predicted: num(of, "predictedReliability"),
  track: list(of, "track").map(cell),
});

/** The layers of a look, without the readings. */
export const look = (of: Fields, decision: number): model.Look => ({
  number: num(of, "number"),
  decision,
  timeS: num(sub(of, "spent"), "timeS"),
  pose: cell(sub(sub(of, "pose"), "cell")),
  windows: list(of, "windows").map((window) => ({
    layer: str(window, "layer"),
    row: num(window, "row"),
    col: num(window, "col"),
    rows: num(window, "rows"),
    cols: num(window, "cols"),
  })),
});

/** Word from outside, in a sentence. */
export const message = (of: Fields, timeS: number, decision: number): model.Happening => {
  const kind = str(of, "kind");
  const name = str(of, "name");
  const target = maybeCell(of.target);
  const asked: Record<string, string> = {
    pursue: `${name}: pursue ${str(of, "directive")}${target ? ` at (${target.row}, ${target.col})` : ""}`,
    withdraw: `${name} withdrawn`,
    facts: [...strings(of, "adds").map((f) => `${f} holds`), ...strings(of, "deletes").map((f) => `${f} holds no longer`)].join(", "),
  };
  return { kind: "message", name: name || kind, timeS, decision, text: asked[kind] ?? kind };
};

export const fault = (of: Fields, decision: number): model.Happening => ({
  kind: "fault",
  name: str(of, "name"),
  timeS: num(of, "timeS"),
  decision,
  text: str(of, "text") || str(of, "kind"),
});
