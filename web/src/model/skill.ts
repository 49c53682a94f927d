/** Planner annotation of a state, which makes a library a skill. It is stored in the semantic data in the format of the reference's
 * planner plugin. */

import type { JsonValue, StateDocument } from "./generated/protocol.ts";
import { portsOf } from "./machine.ts";
import {
  CONNECTIVES,
  faultsIn,
  headOf,
  isList,
  objectsIn,
  type PddlFault,
  type PddlObject,
  type PddlSignature,
  type PddlTerm,
  type PddlWords,
  readPddl,
} from "./pddl.ts";
import { type Semantic, valueAt, withoutKey, withValue } from "./semantic.ts";

const KEYS = ["RAFCONTPP", "PDDL_ACTION"] as const;

/** Annotation of a skill, in PDDL. */
export interface SkillNotes {
  readonly pddl_action: string;
  readonly pddl_predicates: string;
  readonly pddl_functions: string;
  readonly pddl_types: string;
  readonly requirements: readonly string[];
  readonly description: string;
}

const TEXTS = [
  "pddl_action",
  "pddl_predicates",
  "pddl_functions",
  "pddl_types",
  "description",
] as const;

/** Features of engines that a skill may require. */
export const REQUIREMENTS = [
  ":strips",
  ":typing",
  ":negative-preconditions",
  ":disjunctive-preconditions",
  ":equality",
  ":existential-preconditions",
  ":universal-preconditions",
  ":conditional-effects",
  ":adl",
  ":fluents",
  ":numeric-fluents",
  ":action-costs",
  ":durative-actions",
] as const;

/** Annotation in semantic data; null if there is none. */
export function skillNotes(data: Semantic): SkillNotes | null {
  if (valueAt(data, KEYS) === undefined) return null;
  const text = (key: string) => {
    const value = valueAt(data, [...KEYS, key]);
    return typeof value === "string" ? value : "";
  };
  const requirements = valueAt(data, [...KEYS, "requirements"]);
  const texts = Object.fromEntries(TEXTS.map((key) => [key, text(key)]));
  return {
    ...(texts as Omit<SkillNotes, "requirements">),
    requirements: Array.isArray(requirements)
      ? requirements.filter((each) => typeof each === "string")
      : [],
  };
}

/** The data with parts of the annotation changed; other data is kept. */
export function withSkillNotes(data: Semantic, changed: Partial<SkillNotes>): JsonValue {
  return Object.entries(changed).reduce<Semantic>(
    (now, [key, value]) => withValue(now, [...KEYS, key], value as JsonValue),
    data,
  ) as JsonValue;
}

/** The data without the annotation. */
export function withoutSkillNotes(data: Semantic): JsonValue {
  const rest = withoutKey(data, KEYS);
  const outer = valueAt(rest, [KEYS[0]]);
  const isEmpty = typeof outer === "object" && outer !== null && Object.keys(outer).length === 0;
  return isEmpty ? withoutKey(rest, [KEYS[0]]) : rest;
}

/** Initial annotation: an action with a parameter for each input. */
export function firstNotes(state: StateDocument): SkillNotes {
  const plain = state.name
    .trim()
    .toLowerCase()
    .replaceAll(/[^a-z0-9]+/g, "-");
  const name = /^[a-z]/.test(plain) ? plain.replace(/-$/, "") : "action";
  const inputs = portsOf(state, "input").map((port) => `?${port.name}`);
  const parameters = inputs.length === 0 ? "" : `${inputs.join(" ")} - object`;
  return {
    pddl_action: `(:action ${name}\n  :parameters (${parameters})\n  :precondition (and)\n  :effect (and))`,
    pddl_predicates: "",
    pddl_functions: "",
    pddl_types: "",
    requirements: [":strips", ":typing"],
    description: "",
  };
}

interface ReadAction {
  readonly parameters: readonly PddlObject[];
  /** Conditions and effects. */
  readonly terms: readonly PddlTerm[];
  readonly faults: readonly PddlFault[];
}

/** Parses the parts of an action. */
function readAction(text: string): ReadAction {
  const { terms, faults } = readPddl(text);
  const [action, second] = terms;
  const head = headOf(action);
  if (!isList(action) || (head !== ":action" && head !== ":durative-action")) {
    const message =
      "Write one action: (:action name :parameters (…) :precondition (…) :effect (…)).";
    return {
      parameters: [],
      terms: [],
      faults: [...faults, { from: 0, to: text.length, message }],
    };
  }
  const more = second ? [{ from: second.from, to: second.to, message: ONE_ACTION }] : [];
  const part = (name: string) => {
    const at = action.items.findIndex((item) => !isList(item) && item.name === name);
    return at < 0 ? undefined : action.items[at + 1];
  };
  const list = part(":parameters");
  const isPart = (term: PddlTerm | undefined): term is PddlTerm =>
    isList(term) && term.items.length > 0;
  return {
    parameters: isList(list) ? objectsIn(list.items) : [],
    terms: [part(":precondition"), part(":condition"), part(":effect")].filter(isPart),
    faults: [...faults, ...more],
  };
}

const ONE_ACTION = "A state has one action: remove this one.";

/** Predicates or functions that a text declares. */
function signaturesIn(text: string, isNumeric: boolean): readonly PddlSignature[] {
  return readPddl(text).terms.flatMap((term): PddlSignature[] => {
    const [first, ...rest] = isList(term) ? term.items : [];
    if (!first || isList(first)) return [];
    const types = objectsIn(rest).map(({ type }) => (type === "" ? [] : [type]));
    return [{ name: first.name, arguments: types, isNumeric }];
  });
}

/** Parent of each type, from `Cup - Dish, Place`. */
function typesIn(text: string): ReadonlyMap<string, string> {
  const parts = text.split(/[,\n]/).map((part) => part.split(" - ").map((each) => each.trim()));
  return new Map(
    parts.flatMap(([child = "", parent = "object"]) =>
      child === "" ? [] : [[child.toLowerCase(), parent.toLowerCase()]],
    ),
  );
}

/** Vocabulary of the action: declarations of this skill, then those known from other skills. */
export function wordsOfNotes(notes: SkillNotes, known: PddlWords): PddlWords {
  const own = [
    ...signaturesIn(notes.pddl_predicates, false),
    ...signaturesIn(notes.pddl_functions, true),
  ];
  const names = new Set(own.map(({ name }) => name.toLowerCase()));
  return {
    signatures: [...own, ...known.signatures.filter(({ name }) => !names.has(name.toLowerCase()))],
    objects: readAction(notes.pddl_action).parameters,
    types: { ...known.types, ...Object.fromEntries(typesIn(notes.pddl_types)) },
  };
}

/** Errors in the text of an action. */
export function faultsOfAction(text: string, words: PddlWords): readonly PddlFault[] {
  const { terms, faults } = readAction(text);
  const isAboutTime = (term: PddlTerm) =>
    /^\(at (start|end)\b|^\(over all\b/.test(textOf(text, term));
  const conditions = terms.flatMap((term) => timeless(term, isAboutTime));
  return [...faults, ...faultsIn(conditions, words)];
}

function textOf(text: string, { from, to }: PddlTerm): string {
  return text.slice(from, to).toLowerCase();
}

/** Conditions of durative actions without their time specifiers. */
function timeless(term: PddlTerm, isAboutTime: (term: PddlTerm) => boolean): readonly PddlTerm[] {
  if (!isList(term)) return [term];
  if (isAboutTime(term)) return term.items.slice(2);
  const hasTimes = headOf(term) === "and" && term.items.some(isAboutTime);
  return hasTimes ? term.items.slice(1).flatMap((each) => timeless(each, isAboutTime)) : [term];
}

/** Mismatches between the action, its declarations and the ports of the state. */
export function skillFaults(notes: SkillNotes, state: StateDocument): readonly string[] {
  const { parameters } = readAction(notes.pddl_action);
  const inputs = portsOf(state, "input");
  const named = (name: string) => name.replace(/^\?/, "").toLowerCase();
  const types = typesIn(notes.pddl_types);
  const declared = new Set([...types.keys(), ...types.values(), "object"]);
  const unsent = parameters.filter(
    ({ name }) => !inputs.some((port) => port.name.toLowerCase() === named(name)),
  );
  const unset = inputs.filter(
    (port) => !parameters.some(({ name }) => named(name) === port.name.toLowerCase()),
  );
  const used = [
    ...parameters.map(({ type }) => type),
    ...signaturesIn(notes.pddl_predicates, false).flatMap((each) => each.arguments.flat()),
  ];
  const unknown = [...new Set(used)].filter(
    (type) => type !== "" && !declared.has(type.toLowerCase()),
  );
  return [
    ...unsent.map(
      ({ name }) => `No input is called ${named(name)}: the state does not learn its value.`,
    ),
    ...unset.map(({ name }) => `No parameter sets the input ${name}: it keeps its default value.`),
    ...unknown.map((type) => `The type ${type} is not among the types.`),
    ...missingPredicates(notes).map(
      ({ name }) => `The predicate ${name} is not among the predicates.`,
    ),
    ...notes.requirements
      .filter((each) => !(REQUIREMENTS as readonly string[]).includes(each))
      .map((each) => `The requirement ${each} is not known.`),
  ];
}

interface MissingPredicate {
  readonly name: string;
  readonly written: string;
}

/** Predicates that the action uses without a declaration, with types from its parameters. */
function missingPredicates(notes: SkillNotes): readonly MissingPredicate[] {
  const { parameters, terms } = readAction(notes.pddl_action);
  const declared = new Set(
    wordsOfNotes(notes, { signatures: [], objects: [], types: {} }).signatures.map(({ name }) =>
      name.toLowerCase(),
    ),
  );
  const found = new Map<string, MissingPredicate>();
  const walk = (term: PddlTerm) => {
    const head = headOf(term);
    if (!isList(term) || head === "") return;
    const isFact = term.items.slice(1).every((item) => !isList(item)) && !(head in CONNECTIVES);
    if (!isFact) return term.items.slice(1).forEach(walk);
    if (declared.has(head) || found.has(head)) return;
    const typed = term.items.slice(1).map((item) => {
      const name = isList(item) ? "" : item.name;
      const type = parameters.find((each) => each.name === name)?.type ?? "";
      const variable = name.startsWith("?") ? name : `?${name}`;
      return type === "" ? variable : `${variable} - ${type}`;
    });
    found.set(head, { name: head, written: `(${[head, ...typed].join(" ")})` });
  };
  terms.forEach(walk);
  return [...found.values()];
}

/** Declarations extended by the predicates and types that the action uses; null if none is missing. */
export function filledIn(notes: SkillNotes): Partial<SkillNotes> | null {
  const { parameters } = readAction(notes.pddl_action);
  const predicates = missingPredicates(notes).map(({ written }) => written);
  const types = typesIn(notes.pddl_types);
  const added = [...new Set(parameters.map(({ type }) => type))].filter(
    (type) => !["", "object"].includes(type) && !types.has(type.toLowerCase()),
  );
  if (predicates.length === 0 && added.length === 0) return null;
  const before = notes.pddl_types.trim();
  return {
    pddl_predicates: [notes.pddl_predicates.trim(), ...predicates].filter(Boolean).join("\n"),
    pddl_types: [before, ...added].filter(Boolean).join(", "),
  };
}
