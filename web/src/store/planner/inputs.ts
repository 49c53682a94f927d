/** Inputs of the planner as a person writes them, stored in this browser for each machine. */

import type { JsonValue, MakePlan, PlanDomain, PlanThen } from "../../model/generated/protocol.ts";
import {
  goalOfText,
  type PddlObject,
  type PddlWords,
  problemOfText,
  textOfProblem,
  typesOfText,
} from "../../model/pddl.ts";

/** An object and its value at run time. */
export interface WorldObject extends PddlObject {
  /** JSON; empty if it has no value. */
  readonly value: string;
}

export interface PlannerInputs {
  /** Library roots, folders and libraries with skills. */
  readonly libraries: readonly string[];
  /** Types in PDDL notation: `cup plate - dish`. */
  readonly types: string;
  readonly objects: readonly WorldObject[];
  readonly facts: string;
  readonly goal: string;
  readonly name: string;
  readonly engine: string;
  readonly limit_s: number;
  readonly anytime: boolean;
  readonly parallel: boolean;
  readonly retries: number;
  readonly lastResort: PlanThen;
  /** Library that observes facts; empty for none. */
  readonly observe: string;
}

export const NO_INPUTS: PlannerInputs = {
  libraries: [],
  types: "",
  objects: [],
  facts: "",
  goal: "",
  name: "Plan",
  engine: "kairos",
  limit_s: 10,
  anytime: false,
  parallel: false,
  retries: 0,
  lastResort: "give_up",
  observe: "",
};

/** Stored inputs, with defaults for fields added since. */
export function keptInputs(value: object | undefined): PlannerInputs {
  return { ...NO_INPUTS, ...value };
}

/** Request for a plan. */
export function requestOf(inputs: PlannerInputs): MakePlan {
  const { libraries, types, objects, facts, goal, name, observe } = inputs;
  const values = objects.flatMap(({ name: object, value }) =>
    value.trim() === "" ? [] : [[object, JSON.parse(value) as JsonValue]],
  );
  return {
    pool: { libraries: [...libraries], types: { ...typesOfText(types) } },
    // The server reports in which part a bracket is missing.
    facts: textOfProblem({ name, objects, facts, goal: "" }),
    goal: goalOfText(goal),
    data: Object.fromEntries(values),
    engine: inputs.engine,
    time_limit_ms: Math.round(inputs.limit_s * 1_000),
    anytime: inputs.anytime,
    parallel: inputs.parallel,
    // biome-ignore lint/suspicious/noThenProperty: the word of the request
    recovery: { retries: inputs.retries, then: inputs.lastResort },
    name: name.trim() === "" ? "Plan" : name.trim(),
    ...(observe.trim() === "" ? {} : { observe: observe.trim() }),
  };
}

/** Key of skills, world and goal: a plan is valid only for an equal key. */
export function questionOf({ libraries, types, objects, facts, goal }: PlannerInputs): string {
  return JSON.stringify([libraries, types, objects, facts, goal]);
}

/** Reason why no plan can be requested yet, with the remedy; null if it can. */
export function missingIn({ libraries, goal, limit_s, objects }: PlannerInputs): string | null {
  if (libraries.length === 0) return "Add a library with skills first.";
  if (goal.trim() === "") return "Say what is to be reached: write a goal.";
  if (!(limit_s > 0 && limit_s <= 3_600)) return "The time limit is from 0.001 to 3600 s.";
  const bad = objects.find(({ value }) => valueFault(value) !== null);
  return bad ? `The value of ${bad.name} is no JSON: change it.` : null;
}

/** Reason why a text is not a value; null if it is one, or is empty. */
export function valueFault(text: string): string | null {
  if (text.trim() === "") return null;
  try {
    JSON.parse(text);
    return null;
  } catch (error) {
    return `This is not JSON: ${error instanceof Error ? error.message : String(error)}`;
  }
}

/** Vocabulary of facts and goals: the predicates and functions of the skills, and the objects. */
export function wordsOf(domain: PlanDomain | null, { objects, types }: PlannerInputs): PddlWords {
  const signatures = (list: PlanDomain["predicates"], isNumeric: boolean) =>
    list.map(({ name, arguments: all }) => ({
      name,
      arguments: all.map((argument) => argument.types),
      isNumeric,
    }));
  return {
    signatures: [
      ...signatures(domain?.predicates ?? [], false),
      ...signatures(domain?.functions ?? [], true),
    ],
    objects,
    types: inSmallLetters({ ...typesOfText(types), ...domain?.types }),
  };
}

/** Names are case-insensitive. */
function inSmallLetters(types: Readonly<Record<string, string>>): PddlWords["types"] {
  const pairs = Object.entries(types);
  return Object.fromEntries(pairs.map((pair) => pair.map((name) => name.toLowerCase())));
}

/** All types that an object can have. */
export function typesIn(domain: PlanDomain | null): readonly string[] {
  const pairs = Object.entries(domain?.types ?? {});
  return [...new Set(pairs.flat())].filter((type) => type !== "object").sort();
}

/** Inputs with the content of a file: a PDDL problem, or the robot's world file with a value for each object. Returns an error text
 * for other files. */
export function withFile(inputs: PlannerInputs, text: string): PlannerInputs | string {
  const problem = problemOfText(text);
  if (problem) {
    const values = new Map(inputs.objects.map(({ name, value }) => [name, value]));
    const objects = problem.objects.map((each) => ({
      ...each,
      value: values.get(each.name) ?? "",
    }));
    const goal = problem.goal === "" ? inputs.goal : problem.goal;
    return { ...inputs, objects, facts: problem.facts, goal, name: problem.name || inputs.name };
  }
  const world = jsonObject(text);
  if (!world) return "The file is neither a PDDL problem nor JSON with a value for each object.";
  const written = (value: unknown) => JSON.stringify(value);
  const known = inputs.objects.map((each) =>
    each.name in world ? { ...each, value: written(world[each.name]) } : each,
  );
  const names = new Set(known.map(({ name }) => name));
  const others = Object.entries(world).filter(([name]) => !names.has(name));
  const added = others.map(([name, value]) => ({ name, type: "", value: written(value) }));
  return { ...inputs, objects: [...known, ...added] };
}

function jsonObject(text: string): Readonly<Record<string, unknown>> | null {
  try {
    const value: unknown = JSON.parse(text);
    const isObject = typeof value === "object" && value !== null && !Array.isArray(value);
    return isObject ? (value as Record<string, unknown>) : null;
  } catch {
    return null;
  }
}
