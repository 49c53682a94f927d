/** Search in a machine: names, ids, descriptions, scripts, outcomes, ports, types, values and libraries. The texts of a state are
 * cached as long as its document is unchanged. */

import type { ElementRef } from "./element.ts";
import type { PortDocument, StateDocument } from "./generated/protocol.ts";
import { type Machine, outcomesOf, type PortKind, portsOf } from "./machine.ts";
import { type Match, match, type Query, queryOf, scoreOf, type TextSpan } from "./match.ts";
import { idOf } from "./path.ts";
import { perOwner } from "./per_owner.ts";
import { python } from "./value.ts";

/** Kind of a text. */
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

/** One search result. */
export interface SearchHit {
  readonly field: SearchField;
  /** The state, or its port or outcome. */
  readonly element: ElementRef;
  /** The matching text; for long texts the matching line. */
  readonly text: string;
  readonly spans: readonly TextSpan[];
  /** Line in a script or description, from 1; null for other fields. */
  readonly line: number | null;
  readonly score: number;
}

/** Groups of fields that can be searched separately. */
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

/** Weights of fields: a typed word is most often a name. */
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
  /** Lower case, for a fast first check. */
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

/** The default value, or the value that a library state sets instead. */
function valueText(state: StateDocument, kind: PortKind, port: PortDocument): string | null {
  const values = kind === "input" ? state.library?.inputs : state.library?.outputs;
  const set = values?.find((value) => value.port === port.id && value.used);
  const value = set ? set.value : port.default;
  return value === undefined || value === null || value === "" ? null : python(value);
}

interface SearchOptions {
  /** Group of fields to search; all if missing. */
  readonly scope?: SearchScope | null;
  /** Greatest number of results. */
  readonly count: number;
}

interface SearchHits {
  /** Best results first. */
  readonly hits: readonly SearchHit[];
  /** Total number of results, including those not returned. */
  readonly total: number;
}

/** A matching text. The exact position is determined only for returned results. */
interface Candidate {
  readonly path: string;
  readonly text: Text;
  readonly score: number;
}

/** Searches a machine, including the loaded content of libraries. */
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

/** Candidates by score, so that only the returned ones are sorted. */
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

/** First line with all words, otherwise the first line with the first word. */
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
