/** Semantic data: the user's notes of a state, as keys with values or inner keys. */

import type { JsonValue } from "./generated/protocol.ts";
import { parseLiteral } from "./literal.ts";
import { python } from "./value.ts";

/** Keys from the outermost to the innermost. */
type KeyPath = readonly string[];

/** One key with its nesting. */
export interface SemanticRow {
  readonly keys: KeyPath;
  /** Null for a key with inner keys. */
  readonly text: string | null;
  /** Number of inner keys. */
  readonly size: number;
}

type KeyValues = readonly (readonly [string, JsonValue])[];
export type Semantic = JsonValue | null | undefined;

/** All keys, each before its inner ones. Inner keys of folded ones are omitted. */
export function semanticRows(data: Semantic, folded: ReadonlySet<string>): readonly SemanticRow[] {
  const rows: SemanticRow[] = [];
  const walk = (pairs: KeyValues, outer: KeyPath) => {
    for (const [key, value] of pairs) {
      const keys = [...outer, key];
      const inside = pairsOf(value);
      rows.push({ keys, text: inside ? null : textOf(value), size: inside?.length ?? 0 });
      if (inside && !folded.has(rowKey(keys))) walk(inside, keys);
    }
  };
  walk(pairsOf(data ?? {}) ?? [], []);
  return rows;
}

/** Unique text of a path of keys. */
export function rowKey(keys: KeyPath): string {
  return JSON.stringify(keys);
}

/** Text of a value. Strings have quotes only if they would be misread without them. */
export function textOf(value: JsonValue): string {
  if (typeof value !== "string") return python(value);
  const isPlain = value !== "" && value === value.trim() && !/[\n\r]/.test(value);
  return isPlain && "refused" in parseLiteral(value) ? value : python(value);
}

/** Value of a typed text: a Python literal, otherwise the text itself. */
export function valueOfText(text: string): JsonValue {
  const literal = parseLiteral(text);
  return "value" in literal ? literal.value : text;
}

export type Changed = { readonly data: JsonValue } | { readonly refused: string };

/** Value under these keys; undefined if there is none. */
export function valueAt(data: Semantic, keys: KeyPath): JsonValue | undefined {
  const key = keys.at(-1);
  return pairsAt(data, keys.slice(0, -1)).find(([name]) => name === key)?.[1];
}

/** The data with this value under these keys. */
export function withValue(data: Semantic, keys: KeyPath, value: JsonValue): JsonValue {
  const [key, ...inner] = keys;
  if (key === undefined) return value;
  const pairs = pairsOf(data ?? {}) ?? [];
  const put = (old: Semantic) => (inner.length === 0 ? value : withValue(old, inner, value));
  const isThere = pairs.some(([name]) => name === key);
  const next: KeyValues = isThere
    ? pairs.map(([name, old]) => [name, name === key ? put(old) : old] as const)
    : [...pairs, [key, put(null)]];
  return dictionary(next);
}

/** The data without the key. */
export function withoutKey(data: Semantic, keys: KeyPath): JsonValue {
  const key = keys.at(-1);
  const outer = keys.slice(0, -1);
  const pairs = pairsAt(data, outer).filter(([name]) => name !== key);
  return withValue(data, outer, dictionary(pairs));
}

/** The data with the key renamed, at its current place. */
export function withKey(data: Semantic, keys: KeyPath, wanted: string): Changed {
  const name = wanted.trim();
  const key = keys.at(-1) ?? "";
  const outer = keys.slice(0, -1);
  const pairs = pairsAt(data, outer);
  if (name === "") return { refused: "A key needs a name: enter one, or remove the row." };
  if (name !== key && pairs.some(([other]) => other === name)) {
    return { refused: `The key ${name} already exists. Choose another name.` };
  }
  const next = pairs.map(([other, value]) => [other === key ? name : other, value] as const);
  return { data: withValue(data, outer, dictionary(next)) };
}

/** The data with a new key under `outer`, and the path of that key. */
export function withNewKey(
  data: Semantic,
  outer: KeyPath,
  value: JsonValue,
): { readonly data: JsonValue; readonly keys: KeyPath } {
  const taken = new Set(pairsAt(data, outer).map(([key]) => key));
  let name = "key";
  for (let number = 1; taken.has(name); number++) name = `key_${number}`;
  const keys = [...outer, name];
  return { data: withValue(data, keys, value), keys };
}

function pairsAt(data: Semantic, keys: KeyPath): KeyValues {
  const [key, ...inner] = keys;
  const pairs = pairsOf(data ?? {}) ?? [];
  if (key === undefined) return pairs;
  return pairsAt(pairs.find(([name]) => name === key)?.[1], inner);
}

/** Entries of a dict with text keys; null for other values. */
function pairsOf(value: JsonValue): KeyValues | null {
  if (value === null || typeof value !== "object" || Array.isArray(value)) return null;
  const keys = Object.keys(value);
  const [only] = keys;
  if (keys.length !== 1 || only === undefined || !only.startsWith("__")) {
    return keys.map((key) => [key, value[key] ?? null]);
  }
  const marked = only === "__dict__" ? value[only] : null;
  if (!Array.isArray(marked)) return null;
  const pairs = marked as unknown as readonly (readonly [JsonValue, JsonValue])[];
  return pairs.every(([key]) => typeof key === "string") ? (pairs as KeyValues) : null;
}

/** A dict, marked as one where a plain object would change it. */
function dictionary(pairs: KeyValues): JsonValue {
  const isPlain = pairs.every(([key]) => !key.startsWith("__") && !/^\d+$/.test(key));
  if (isPlain) return Object.fromEntries(pairs);
  return { __dict__: pairs.map(([key, value]) => [key, value]) };
}
