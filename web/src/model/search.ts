/** Search over a machine: names, ids, descriptions, scripts, outcomes, ports, types, values and libraries at once. What is
 * known of a state is kept as long as its document is the same. */

import type { ElementRef } from "./element.ts";
import type { PortDocument, StateDocument } from "./generated/protocol.ts";
import { type Machine, outcomesOf, type PortKind, portsOf } from "./machine.ts";
import { type Match, match, type Query, queryOf, scoreOf, type TextSpan } from "./match.ts";
import { idOf } from "./path.ts";
import { perOwner } from "./per_owner.ts";
import { python } from "./value.ts";

/** What a text is. */
export type SearchField =
  | "name"
  | "id"
  | "description"
  | "script"
  | "outcome"
  | "input"
  | "output"
  | "scoped_variable"
  | "type"
  | "value"
  | "library"
  | "semantic data";

/** One place where something was found. */
export interface SearchHit {
  readonly field: SearchField;
  /** The state, or its port or outcome. */
  readonly element: ElementRef;
  /** The text; of long ones the line. */
  readonly text: string;
  readonly spans: readonly TextSpan[];
  /** Of scripts and descriptions: the line, from 1. */
  readonly line: number | null;
  readonly score: number;
}

/** Kinds of places that one can ask for alone. */
export type SearchScope = "names" | "ports" | "scripts" | "descriptions" | "values" | "libraries";

const SCOPES: Readonly<Record<SearchField, SearchScope>> = {
  name: "names",
  id: "names",
  outcome: "ports",
  input: "ports",
  output: "ports",
  scoped_variable: "ports",
  type: "ports",
  value: "values",
  "semantic data": "values",
  description: "descriptions",
  script: "scripts",
  library: "libraries",
};

/** How much a field weighs: who types a word most often means a name. */
const WEIGHTS: Readonly<Record<SearchField, number>> = {
  name: 100,
  library: 55,
  outcome: 50,
  input: 50,
  output: 50,
  scoped_variable: 50,
  id: 45,
  type: 20,
  value: 20,
  description: 15,
  script: 10,
  "semantic data": 10,
};

interface Text {
  readonly field: SearchField;
  readonly text: string;
  /** Small letters, to see quickly that something is not there. */
  readonly lower: string;
  readonly part: { readonly kind: PortKind | "outcome"; readonly id: number } | null;
}

const textsOf = perOwner(read);

function read(state: StateDocument): readonly Text[] {
  const found: Text[] = [];
  const add = (field: SearchField, text: string | null | undefined, part: Text["part"] = null) => {
    if (text) found.push({ field, text, lower: text.toLowerCase(), part });
  };
  add("name", state.name);
  add("id", idOf(state.path));
  add("description", state.description);
  add("script", state.script);
  for (const { id, name } of outcomesOf(state)) {
    if (id >= 0) add("outcome", name, { kind: "outcome", id });
  }
  for (const kind of ["input", "output", "scoped_variable"] as const) {
    for (const port of portsOf(state, kind)) {
      const part = { kind, id: port.id };
      add(kind, port.name, part);
      add("type", port.data_type, part);
      add("value", valueText(state, kind, port), part);
    }
  }
  if (state.library) add("library", `${state.library.path}/${state.library.name}`);
  if (state.semantic_data) add("semantic data", python(state.semantic_data));
  return found;
}

/** The default, or what a library state sets instead. */
function valueText(state: StateDocument, kind: PortKind, port: PortDocument): string | null {
  const values = kind === "input" ? state.library?.inputs : state.library?.outputs;
  const set = values?.find((value) => value.port === port.id && value.used);
  const value = set ? set.value : port.default;
  return value === undefined || value === null || value === "" ? null : python(value);
}

interface SearchOptions {
  /** Only these places; left out: all. */
  readonly scope?: SearchScope | null;
  /** At most so many hits. */
  readonly count: number;
}

interface SearchHits {
  /** The best first. */
  readonly hits: readonly SearchHit[];
  /** How many there are, also those that are left out. */
  readonly total: number;
}

/** A place that fits; where exactly is looked for only if it is shown. */
interface Candidate {
  readonly path: string;
  readonly text: Text;
  readonly score: number;
}

/** Looks for a text everywhere in a machine, also in content of libraries that is here. */
export function search(machine: Machine, text: string, options: SearchOptions): SearchHits {
  const query = queryOf(text);
  if (query.words.length === 0) return { hits: [], total: 0 };
  const best = new BestCandidates();
  const pending = [machine.root];
  for (let path = pending.pop(); path !== undefined; path = pending.pop()) {
    const state = machine.state(path);
    if (!state) continue;
    for (const text of textsOf(state)) {
      if (options.scope && SCOPES[text.field] !== options.scope) continue;
      const score = scoreIn(query, text);
      if (score >= 0) best.add({ path, text, score });
    }
    const children = machine.children(path);
    for (let index = children.length - 1; index >= 0; index--) {
      const child = children[index];
      if (child !== undefined) pending.push(child);
    }
  }
  const hits = best.first(options.count).flatMap((candidate) => hitAt(query, candidate) ?? []);
  return { hits, total: best.total };
}

/** Candidates by their score, so that only those that are shown have to be sorted. */
class BestCandidates {
  readonly #byScore: Candidate[][] = [];
  total = 0;

  add(candidate: Candidate): void {
    const score = Math.floor(candidate.score);
    const known = this.#byScore[score];
    if (known) known.push(candidate);
    else this.#byScore[score] = [candidate];
    this.total++;
  }

  first(count: number): readonly Candidate[] {
    const found: Candidate[] = [];
    for (let score = this.#byScore.length - 1; score >= 0 && found.length < count; score--) {
      const equal = this.#byScore[score] ?? [];
      found.push(...equal.slice(0, count - found.length));
    }
    return found;
  }
}

const LONG: ReadonlySet<SearchField> = new Set(["script", "description"]);
const ANYWHERE = 30;

function scoreIn(query: Query, { field, text, lower }: Text): number {
  if (!LONG.has(field)) {
    const score = scoreOf(query, text, lower, field === "name");
    return score < 0 ? score : score + WEIGHTS[field];
  }
  return query.words.every((word) => lower.includes(word)) ? ANYWHERE + WEIGHTS[field] : -1;
}

function hitAt(
  query: Query,
  { path, text: { field, text, part }, score }: Candidate,
): SearchHit | null {
  const found = LONG.has(field) ? lineWith(query, text) : whole(match(query, text, true), text);
  if (!found) return null;
  const element: ElementRef = part ? { ...part, path } : { kind: "state", path };
  return { field, element, text: found.text, spans: found.match.spans, line: found.line, score };
}

interface MatchedLine {
  readonly match: Match;
  readonly text: string;
  readonly line: number | null;
}

function whole(found: Match | null, text: string): MatchedLine | null {
  return found && { match: found, text, line: null };
}

/** The first line with all words, or else with the first of them. */
function lineWith(query: Query, text: string): MatchedLine | null {
  const lines = text.split("\n");
  const [first] = query.words;
  for (const wanted of [query, { words: first === undefined ? [] : [first] }]) {
    for (const [index, line] of lines.entries()) {
      const plain = line.trim();
      const found = match(wanted, plain);
      if (found) return { match: found, text: plain, line: index + 1 };
    }
  }
  return null;
}
