/** Parses, writes, checks and completes facts, goals and problems in PDDL. */

/** A name, or a list in brackets, with its position in the text. */
export type PddlTerm = PddlName | PddlList;

interface PddlName {
  readonly name: string;
  readonly from: number;
  readonly to: number;
}

export interface PddlList {
  readonly items: readonly PddlTerm[];
  readonly from: number;
  readonly to: number;
}

/** An error at a position of a text. */
export interface PddlFault {
  readonly from: number;
  readonly to: number;
  readonly message: string;
}

/** An object of the world. */
export interface PddlObject {
  readonly name: string;
  /** Empty without a type. */
  readonly type: string;
}

/** A problem: its objects, facts and goal. */
export interface PddlProblem {
  readonly name: string;
  readonly objects: readonly PddlObject[];
  /** One fact per line. */
  readonly facts: string;
  /** One condition per line. */
  readonly goal: string;
}

/** Vocabulary of facts and goals. */
export interface PddlWords {
  readonly signatures: readonly PddlSignature[];
  readonly objects: readonly PddlObject[];
  /** Parent of each type. */
  readonly types: Readonly<Record<string, string>>;
}

export interface PddlSignature {
  readonly name: string;
  /** Allowed types of each argument; an empty list allows any. */
  readonly arguments: readonly (readonly string[])[];
  readonly isNumeric: boolean;
}

const TOKEN = /;[^\n]*|[()]|[^\s();]+/g;

export function isList(term: PddlTerm | undefined): term is PddlList {
  return term !== undefined && "items" in term;
}

/** First name of a list in lower case; empty if there is none. */
export function headOf(term: PddlTerm | undefined): string {
  const first = isList(term) ? term.items[0] : undefined;
  return first && !isList(first) ? first.name.toLowerCase() : "";
}

/** All terms of a text, and its unmatched brackets. */
export function readPddl(text: string): {
  readonly terms: readonly PddlTerm[];
  readonly faults: readonly PddlFault[];
} {
  const faults: PddlFault[] = [];
  const terms: PddlTerm[] = [];
  const open: { items: PddlTerm[]; from: number }[] = [];
  for (const { 0: token, index: from } of text.matchAll(TOKEN)) {
    const to = from + token.length;
    const items = open.at(-1)?.items ?? terms;
    if (token.startsWith(";")) continue;
    if (token === "(") open.push({ items: [], from });
    else if (token !== ")") items.push({ name: token, from, to });
    else {
      const list = open.pop();
      if (list) (open.at(-1)?.items ?? terms).push({ ...list, to });
      else faults.push({ from, to, message: "This bracket closes nothing: remove it." });
    }
  }
  for (const { from } of open) {
    faults.push({ from, to: from + 1, message: "This bracket is not closed: add a )." });
  }
  return { terms, faults };
}

/** Objects of a typed list: `a b - place c`. */
export function objectsIn(items: readonly PddlTerm[]): readonly PddlObject[] {
  const objects: PddlObject[] = [];
  let names: string[] = [];
  const take = (type: string) => {
    objects.push(...names.map((name) => ({ name, type })));
    names = [];
  };
  for (let at = 0; at < items.length; at++) {
    const item = items[at];
    if (!item || isList(item)) continue;
    const type = items[at + 1];
    if (item.name !== "-") names.push(item.name);
    else if (type) {
      take(isList(type) ? "" : type.name);
      at++;
    }
  }
  take("");
  return objects;
}

/** Parent of each type, from `cup plate - dish`. */
export function typesOfText(text: string): Readonly<Record<string, string>> {
  const pairs = objectsIn(readPddl(text).terms).filter(({ type }) => type !== "");
  return Object.fromEntries(pairs.map(({ name, type }) => [name, type]));
}

/** Parses a problem; null if the text is not one. */
export function problemOfText(text: string): PddlProblem | null {
  const root = readPddl(text).terms.find((term) => headOf(term) === "define");
  if (!isList(root)) return null;
  const part = (head: string) => {
    const found = root.items.find((item) => headOf(item) === head);
    return isList(found) ? found.items.slice(1) : [];
  };
  const [name] = part("problem");
  const goal = part(":goal");
  const [only] = goal;
  const isAll = goal.length === 1 && headOf(only) === "and" && isList(only);
  const written = (terms: readonly PddlTerm[]) =>
    terms.map(({ from, to }) => text.slice(from, to)).join("\n");
  return {
    name: name && !isList(name) ? name.name : "",
    objects: objectsIn(part(":objects")),
    facts: written(part(":init")),
    goal: written(isAll ? only.items.slice(1) : goal),
  };
}

/** Text of a problem for an engine. */
export function textOfProblem({ name, objects, facts, goal }: PddlProblem): string {
  const typed = objects.map(({ name, type }) => (type === "" ? null : `${name} - ${type}`));
  // Objects without a type come last, because a type applies to all names before it.
  const bare = objects.filter(({ type }) => type === "").map((object) => object.name);
  const list = [...typed.filter((text) => text !== null), ...bare].join("\n    ");
  return `(define (problem ${symbolOf(name)})
  (:domain skills)
  (:objects
    ${list})
  (:init
    ${facts})
  (:goal
    ${goalOfText(goal)}))
`;
}

/** Converts a name to a valid PDDL symbol. */
function symbolOf(name: string): string {
  const plain = name.trim().replaceAll(/[^A-Za-z0-9_-]+/g, "-");
  return /^[A-Za-z]/.test(plain) ? plain : "plan";
}

/** Goal of a text. Several lines are combined with `and`. A text with a fault is unchanged: the server reports the line. */
export function goalOfText(text: string): string {
  const { terms, faults } = readPddl(text);
  return terms.length === 1 || faults.length > 0 ? text.trim() : `(and ${text.trim()})`;
}

/** True if a type equals another or is derived from it. */
export function isKindOf(type: string, wanted: string, types: PddlWords["types"]): boolean {
  const seen = new Set<string>();
  let at: string | undefined = type.toLowerCase();
  const goal = wanted.toLowerCase();
  if (goal === "object") return true;
  for (; at !== undefined && !seen.has(at); at = types[at]) {
    if (at === goal) return true;
    seen.add(at);
  }
  return false;
}

/** Words of goals and facts that are not predicates. */
export const CONNECTIVES: Readonly<Record<string, string>> = {
  and: "all of these",
  or: "any of these",
  not: "not so",
  when: "if the first holds, the second is brought about",
  increase: "",
  decrease: "",
  assign: "",
  imply: "if the first, then the second",
  forall: "for all (?x - type)",
  exists: "for some (?x - type)",
  "=": "is equal",
  "<": "less",
  ">": "more",
  "<=": "at most",
  ">=": "at least",
  "+": "",
  "-": "",
  "*": "",
  "/": "",
};

/** Errors of a text: brackets, predicates, objects, and numbers of arguments. */
export function faultsOf(text: string, words: PddlWords): readonly PddlFault[] {
  const { terms, faults } = readPddl(text);
  return [...faults, ...faultsIn(terms, words)];
}

/** Errors of conditions or facts. */
export function faultsIn(terms: readonly PddlTerm[], words: PddlWords): readonly PddlFault[] {
  const found: PddlFault[] = [];
  for (const term of terms) {
    if (isList(term)) check(term, words, found);
    else found.push({ ...placeOf(term), message: "Write a fact in parentheses: (on a b)." });
  }
  return found;
}

function placeOf({ from, to }: PddlTerm) {
  return { from, to };
}

function check(list: PddlList, words: PddlWords, faults: PddlFault[]): void {
  const head = headOf(list);
  const rest = list.items.slice(1);
  const signature = words.signatures.find(({ name }) => name.toLowerCase() === head);
  if (!signature) {
    // Time specifiers of timed facts and durative actions.
    const isTimed = (head === "at" || head === "over") && isList(rest[1]);
    if (!isTimed && !(head in CONNECTIVES)) faults.push(unknownHead(list, head, words));
    for (const item of rest) {
      const isBinding = head === "forall" || head === "exists";
      if (isList(item) && !(isBinding && item === rest[0])) check(item, words, faults);
    }
    return;
  }
  const expected = signature.arguments.length;
  if (rest.length !== expected) {
    const message = `${signature.name} takes ${counted(expected)}, but has ${rest.length}.`;
    faults.push({ ...placeOf(list), message });
    return;
  }
  rest.forEach((item, index) => {
    const fault = isList(item) ? null : faultOfObject(item.name, signature, index, words);
    if (fault !== null) faults.push({ ...placeOf(item), message: fault });
  });
}

function unknownHead(list: PddlList, head: string, { signatures }: PddlWords): PddlFault {
  const known = signatures.map(({ name }) => name).join(", ");
  const message =
    head === ""
      ? "A fact begins with a predicate."
      : `No skill knows ${head}. There is: ${known === "" ? "nothing yet" : known}.`;
  return { ...placeOf(list.items[0] ?? list), message };
}

function faultOfObject(
  name: string,
  signature: PddlSignature,
  index: number,
  { objects, types }: PddlWords,
): string | null {
  const object = objects.find((each) => each.name.toLowerCase() === name.toLowerCase());
  if (!object && name.startsWith("?")) return null;
  if (!object) return `There is no object ${name}: add it to the objects.`;
  const expected = signature.arguments[index] ?? [];
  if (expected.length === 0 || object.type === "") return null;
  if (expected.some((type) => isKindOf(object.type, type, types))) return null;
  return `${name} is ${object.type}, and ${signature.name} takes ${expected.join(" or ")} here.`;
}

function counted(many: number): string {
  return many === 1 ? "1 object" : `${many} objects`;
}

/** A completion at the cursor. */
export interface PddlOffer {
  readonly label: string;
  readonly detail: string;
  readonly kind: "predicate" | "word" | "object" | "type";
}

/** Completions at the end of a text: predicates after a bracket, then objects of the type that the predicate requires. */
export function offersAt(
  before: string,
  words: PddlWords,
): { readonly typed: string; readonly offers: readonly PddlOffer[] } {
  const typed = /[^\s()]*$/.exec(before)?.[0] ?? "";
  const head = before.slice(0, before.length - typed.length);
  const open = innermost(head);
  if (open === null) return { typed, offers: [] };
  const [first, ...args] = open;
  if (open.at(-1) === "-") return { typed, offers: typesAsOffers(words) };
  if (first === ":action") return { typed, offers: typed.startsWith(":") ? PARTS_OF_ACTION : [] };
  if (first === undefined) return { typed, offers: heads(words) };
  const signature = words.signatures.find(({ name }) => name.toLowerCase() === first.toLowerCase());
  const wanted = signature?.arguments[args.length];
  if (!wanted) return { typed, offers: [] };
  const fits = ({ type }: PddlObject) =>
    wanted.length === 0 || type === "" || wanted.some((each) => isKindOf(type, each, words.types));
  const offers = words.objects
    .filter(fits)
    .map(({ name, type }): PddlOffer => ({ label: name, detail: type, kind: "object" }));
  return { typed, offers };
}

/** Content of the open bracket at the end of a text; null if none is open. An inner list counts as one word. */
function innermost(text: string): readonly string[] | null {
  const open: string[][] = [];
  for (const [token] of text.matchAll(TOKEN)) {
    if (token.startsWith(";")) continue;
    if (token === "(") open.push([]);
    else if (token === ")") {
      open.pop();
      open.at(-1)?.push("()");
    } else open.at(-1)?.push(token);
  }
  return open.at(-1) ?? null;
}

const PARTS_OF_ACTION = [":parameters", ":precondition", ":effect", ":duration", ":condition"].map(
  (label): PddlOffer => ({ label, detail: "", kind: "word" }),
);

function typesAsOffers({ types }: PddlWords): readonly PddlOffer[] {
  const names = [...new Set(Object.entries(types).flat())].sort();
  return names.map((label): PddlOffer => ({ label, detail: "", kind: "type" }));
}

function heads({ signatures }: PddlWords): readonly PddlOffer[] {
  const own = signatures.map(
    (signature): PddlOffer => ({
      label: signature.name,
      detail: signature.arguments.map((types) => types.join("|") || "any").join(" "),
      kind: "predicate",
    }),
  );
  const words = Object.entries(CONNECTIVES).filter(([, detail]) => detail !== "");
  return [...own, ...words.map(([label, detail]): PddlOffer => ({ label, detail, kind: "word" }))];
}
