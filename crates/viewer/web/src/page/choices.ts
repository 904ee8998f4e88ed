// What maps there are to choose from, and the scale that each is shown by.

import type { DerivedPlane, Index } from "../derived/types";
import { range } from "../model/plane";
import type { Plane } from "../model/plane";
import type { PlaneClass, PlaneName } from "../model/types";
import { DERIVED } from "../planes";
import type { Aspect, View } from "../state";
import type { Scale } from "../view/paint";

/** In the order that they are offered in. */
export const GROUPS = ["interest", "readings as logged", "layers as used", "uncertainty", "ground", "masses", "credits", "other maps"] as const;

export type ChoiceGroup = (typeof GROUPS)[number];

export interface Choice {
  id: string;
  /** Without what the map is made of: `interest`, `credit-texture`. */
  name: string;
  label: string;
  unit: string;
  group: ChoiceGroup;
  classes: readonly PlaneClass[];
}

const GROUP_OF: Record<DerivedPlane["group"], ChoiceGroup> = {
  interest: "interest",
  layer: "layers as used",
  uncertainty: "uncertainty",
  ground: "ground",
  mass: "masses",
  credit: "credits",
};

const isMap = (id: string): boolean => id.startsWith("map:");
const isDoubt = (id: string): boolean => id.startsWith("doubt:");

/** The maps of a log, and those derived from it. Where the log has a map itself, that is the one shown. */
export const choices = (logged: readonly PlaneName[], index: Index | undefined): Choice[] => {
  const planes = index && "planes" in index ? index.planes : [];
  const derived = new Map(planes.map((plane) => [plane.name, plane]));
  const inLog = new Set(logged.map(({ id }) => id));
  // A log has the elevation as it was first known; what is derived goes on changing.
  const first = "map:elevation";
  const own = logged.map((one) => ofLog(one, derived.get(one.id.slice(one.id.indexOf(":") + 1)), one.id === first));
  const more = planes
    .filter(({ name }) => !inLog.has(`map:${name}`) || first === `map:${name}`)
    .map((one): Choice => ({ ...one, id: `${DERIVED}${one.name}`, group: GROUP_OF[one.group] }));
  const all = [...own, ...more];
  return GROUPS.flatMap((group) => all.filter((one) => one.group === group));
};

/** A map of the log, with what is known of the derived one of its name. */
const ofLog = (one: PlaneName, known: DerivedPlane | undefined, first: boolean): Choice => {
  const { id } = one;
  const name = id.slice(id.indexOf(":") + 1);
  // A map of the log by the name of a derived one is that one.
  const told = isMap(id) && !first ? known : undefined;
  const logged = name === "interest" ? "interest" : id === "map:elevation" ? "readings as logged" : "other maps";
  const group = isMap(id) ? (told ? GROUP_OF[told.group] : logged) : isDoubt(id) ? "uncertainty" : "readings as logged";
  // The mission file says which values are classes; what they are called only the derived layer tells.
  const classes = isDoubt(id) ? [] : known && known.classes.length > 0 ? known.classes : (one.classes ?? []);
  return { id, name, label: (told ?? one).label, unit: (told ?? one).unit ?? "", group, classes };
};

/** A class by its number and its name; where the name is nothing but the number, it says that it is a class. */
export const className = ({ value, name }: PlaneClass): string => (name === String(value) ? `class ${name}` : name.split(" ").includes(String(value)) ? name : `${value} ${name}`);

export const title = ({ label, unit }: Choice): string => (unit ? `${label}, ${unit}` : label);

/** What is shown of a layer, in words. */
export const aspectTitle = (choice: Choice, aspect: Aspect): string =>
  aspect === "value" ? title(choice) : aspect === "change" ? `change of ${title(choice)} since last` : `${title(choice)}: A less B`;

const SAME: readonly PlaneClass[] = [
  { value: 0, name: "the same" },
  { value: 1, name: "another" },
];

/** The classes that a map shows, if it shows classes. */
export const classesShown = (choice: Choice, aspect: Aspect): readonly PlaneClass[] =>
  choice.classes.length === 0 ? [] : aspect === "value" ? choice.classes : SAME;

/** Beliefs, masses and chances: between nothing and one. */
const isShare = ({ id, name, group }: Choice): boolean =>
  isDoubt(id) || group === "masses" || group === "uncertainty" || (group === "interest" && name !== "hazard") || name === "reliability";

/** Differences that are not worth a colour are shown as none. */
const LEAST_SHARE = 0.05;
/** Rounding of single precision must not make a share more than one. */
const SLACK = 1e-5;

/** What colours a layer is shown in, and from where to where; one scale for both runs. */
export const scaleOf = (choice: Choice, aspect: Aspect, planes: readonly (Plane | undefined)[], colours: View["colours"]): Scale => {
  const classes = classesShown(choice, aspect);
  if (classes.length > 0) return { colours: "classes", min: 0, max: 1, classes: classes.map(({ value }) => value) };
  const ranges = planes.flatMap((plane) => (plane && range(plane)) ?? []);
  const found = ranges.length > 0 ? { min: Math.min(...ranges.map(({ min }) => min)), max: Math.max(...ranges.map(({ max }) => max)) } : { min: 0, max: 1 };
  const share = isShare(choice);
  if (aspect !== "value") {
    const most = Math.max(share || choice.group === "credits" ? LEAST_SHARE : 0, Math.abs(found.min), Math.abs(found.max)) || 1;
    return { colours: "diverging", min: -most, max: most };
  }
  if (choice.group === "credits") {
    // Credits sum to 1, but one may be more, and another less than −1.
    const more = found.min < -1 - SLACK || found.max > 1 + SLACK;
    return { colours: "diverging", min: -1, max: 1, ...(more ? { beyond: found } : {}) };
  }
  const within = found.min >= -SLACK && found.max <= 1 + SLACK;
  const map = choice.group === "uncertainty" ? "cividis" : choice.name === "elevation" ? "stone" : colours;
  return share && within ? { colours: map, min: 0, max: 1 } : { colours: map, ...found };
};
