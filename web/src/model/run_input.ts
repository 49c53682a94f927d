/** Values for the inputs of a run: from Python literals as people type them to what a runner reads. */

import { readDefault } from "./default_text.ts";
import type { JsonValue } from "./generated/protocol.ts";
import type { Literal } from "./literal.ts";

/** The value of what was typed for an input of this type, or why it cannot be given to a run. */
export function readInput(text: string, type: string): Literal {
  if (text.trim().startsWith("$"))
    return { refused: "a run needs a value here, not a global variable" };
  const read = readDefault(text, type);
  if ("refused" in read) return read;
  try {
    return { value: forRunner(read.value) };
  } catch (error) {
    if (error instanceof NotGiven) return { refused: error.message };
    throw error;
  }
}

class NotGiven extends Error {}

function forRunner(value: JsonValue): JsonValue {
  if (Array.isArray(value)) return value.map(forRunner);
  if (typeof value !== "object" || value === null) return value;
  const [[key, inner = null] = [""], ...more] = Object.entries(value);
  return more.length === 0 && key.startsWith("__") ? marked(key, inner) : members(value);
}

function marked(key: string, inner: JsonValue): JsonValue {
  switch (key) {
    case "__float__":
      if (!Number.isFinite(Number(inner))) throw new NotGiven(`${inner} cannot be given to a run`);
      return Number(inner);
    case "__int__":
      throw new NotGiven(`${inner} is too large to be given to a run`);
    case "__tuple__":
    case "__set__":
      return collection(key.replaceAll("_", ""), inner as JsonValue[]);
    case "__dict__":
      return dictionary(inner as [JsonValue, JsonValue][]);
    case "__type__":
      return { __type__: String(inner).replace(/^builtins\./, "") };
  }
  return { [key]: forRunner(inner) };
}

function members(value: { readonly [key in string]?: JsonValue }): JsonValue {
  return Object.fromEntries(
    Object.entries(value).map(([key, inner]) => [key, forRunner(inner ?? null)]),
  );
}

function collection(name: string, items: readonly JsonValue[]): JsonValue {
  return { __jsonqualname__: `__builtin__.${name}`, items: items.map(forRunner) };
}

/** A runner reads keys as whole numbers if all of them can be, else as texts. */
function dictionary(pairs: readonly [JsonValue, JsonValue][]): JsonValue {
  const isNumber = (key: JsonValue) => Number.isInteger(key);
  const isText = (key: JsonValue) => typeof key === "string";
  const isLikeNumber = (key: JsonValue) => /^-?\d+$/.test(String(key));
  const keys = pairs.map(([key]) => key);
  if (!keys.every(isNumber) && (!keys.every(isText) || keys.every(isLikeNumber))) {
    throw new NotGiven("a run only accepts dicts whose keys are texts or whole numbers");
  }
  return Object.fromEntries(pairs.map(([key, inner]) => [String(key), forRunner(inner)]));
}
