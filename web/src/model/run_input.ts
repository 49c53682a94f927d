/** Values of run inputs: converts typed Python literals to values for a runner. */

import { readDefault } from "./default_text.ts";
import type { JsonValue } from "./generated/protocol.ts";
import type { Literal } from "./literal.ts";

/** Value of a typed text for an input of this type, or the reason why a run cannot use it. */
export function readInput(text: string, type: string): Literal {
  if (text.trim().startsWith("$"))
    return { refused: "a run needs a value here, not a global variable" };
  const read = readDefault(text, type);
  if ("refused" in read) return read;
  return { value: forRunner(read.value) };
}

/** Adapts an encoded value to a runner. Dicts with only numeric keys are marked, because a runner would read these keys as numbers,
 * as in files. */
function forRunner(value: JsonValue): JsonValue {
  if (Array.isArray(value)) return value.map(forRunner);
  if (typeof value !== "object" || value === null) return value;
  const members = Object.entries(value).map(([key, inner]): [string, JsonValue] => [
    key,
    memberFor(key, inner ?? null),
  ]);
  const isReadAsNumbers = members.length > 0 && members.every(([key]) => /^-?\d+$/.test(key));
  return isReadAsNumbers ? { __dict__: members } : Object.fromEntries(members);
}

/** Removes the module of built-in types, which a runner does not import. */
function memberFor(key: string, inner: JsonValue): JsonValue {
  return key === "__type__" ? String(inner).replace(/^builtins\./, "") : forRunner(inner);
}
