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
  return { value: forRunner(read.value) };
}

/** The encoding of values goes to a runner as it is, except where a runner reads it as files are read. */
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

/** Built-in types without their module, which a runner does not import. */
function memberFor(key: string, inner: JsonValue): JsonValue {
  return key === "__type__" ? String(inner).replace(/^builtins\./, "") : forRunner(inner);
}
