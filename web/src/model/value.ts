/** Converts wire values (docs/edits.md, values) to Python. */

import type { JsonValue } from "./generated/protocol.ts";

type Marked = Record<string, JsonValue>;

const SPECIAL: Record<string, (inner: JsonValue, deep: (value: JsonValue) => string) => string> = {
  __int__: (inner) => String(inner),
  __float__: (inner) =>
    /^[-+]?(nan|inf)/i.test(String(inner))
      ? `float("${String(inner).toLowerCase()}")`
      : String(inner),
  __tuple__: (inner, deep) => {
    const items = (inner as JsonValue[]).map(deep);
    return items.length === 1 ? `(${items[0]},)` : `(${items.join(", ")})`;
  },
  __set__: (inner, deep) => {
    const items = (inner as JsonValue[]).map(deep);
    return items.length === 0 ? "set()" : `{${items.join(", ")}}`;
  },
  __type__: (inner) => String(inner).replace(/^(__builtin__|builtins)\./, ""),
  __dict__: (inner, deep) =>
    `{${(inner as [JsonValue, JsonValue][]).map(([key, value]) => `${deep(key)}: ${deep(value)}`).join(", ")}}`,
  __object__: (inner) => `<object ${JSON.stringify(inner)}>`,
};

/** The value as a Python literal for people. */
export function python(value: JsonValue | undefined): string {
  if (value === null || value === undefined) return "None";
  if (value === true) return "True";
  if (value === false) return "False";
  if (typeof value === "number") return String(value);
  if (typeof value === "string") return quoted(value);
  if (Array.isArray(value)) return `[${value.map(python).join(", ")}]`;
  const keys = Object.keys(value);
  const only = keys.length === 1 ? keys[0] : undefined;
  const special = only === undefined ? undefined : SPECIAL[only];
  if (only !== undefined && special) return special((value as Marked)[only] ?? null, python);
  return `{${keys.map((key) => `${quoted(key)}: ${python((value as Marked)[key])}`).join(", ")}}`;
}

function quoted(text: string): string {
  return JSON.stringify(text);
}
