/** A value in short form: for ports, table cells, and folded rows. */

import type { JsonValue } from "./generated/protocol.ts";
import { type Read, type ReadArray, read, typeWords } from "./wire.ts";

/** Greatest length. */
const SHORT_MAX = 24;
/** Significant digits of floats. */
const FIGURES = 6;

/** Short form of a value: `3.14`, `"red"`, `[1, 2]`, `list ⟨300⟩`, `float64 ⟨480×640⟩`, `KeyError: 'a'`. */
export function shortValue(value: unknown, max = SHORT_MAX): string {
  const found = read(value);
  const whole = found.kind === "text" ? null : inWords(found, max);
  if (whole !== null && whole.length <= max) return whole;
  return cut(shortened(found, max), max);
}

/** The whole value if it is short; null if it is certainly too long. */
function inWords(found: Read, max: number): string | null {
  switch (found.kind) {
    case "none":
      return "None";
    case "bool":
      return found.value ? "True" : "False";
    case "number":
      return found.of === "int" ? found.text : shortNumber(found.value, found.text);
    case "list":
      return found.items.length < found.count ? null : listed(found.of, found.items, max);
    case "dict":
      return found.entries.length < found.count ? null : entered(found.entries, max);
    case "array":
      return arrayInWords(found, max);
    default:
      return null;
  }
}

function shortened(found: Read, max: number): string {
  switch (found.kind) {
    case "text": {
      const text = found.text.replaceAll(/\s+/g, " ");
      const isCut = text.length > max - 2 || found.count > found.text.length;
      return isCut ? `"${text.slice(0, max - 3)}…"` : `"${text}"`;
    }
    case "error":
      return found.message === "" ? found.of : `${found.of}: ${found.message}`;
    case "type":
      return found.name;
    case "object":
      return found.shown === "" ? typeWords(found) : found.shown;
    case "number":
      return found.text;
    default:
      return typeWords(found);
  }
}

function listed(
  of: "list" | "tuple" | "set",
  items: readonly JsonValue[],
  max: number,
): string | null {
  if (items.length === 0) return { list: "[]", tuple: "()", set: "set()" }[of];
  if (items.length * 3 > max) return null;
  const inner = items.map((item) => shortValue(item, max)).join(", ");
  if (of === "list") return `[${inner}]`;
  if (of === "set") return `{${inner}}`;
  return items.length === 1 ? `(${inner},)` : `(${inner})`;
}

function entered(entries: readonly (readonly [string, JsonValue])[], max: number): string | null {
  if (entries.length * 6 > max) return null;
  return `{${entries.map(([key, value]) => `${key}: ${shortValue(value, max)}`).join(", ")}}`;
}

/** Numbers of a short array. An array without axes is a number. */
function arrayInWords({ items, shape, sampled }: ReadArray, max: number): string | null {
  const isWhole = shape.every((count, axis) => count === sampled[axis]);
  if (!items || !isWhole || shape.length > 1) return null;
  const [only] = items;
  if (shape.length === 0) return only === undefined ? null : shortNumber(only);
  if (items.length * 3 > max || items.length === 0) return null;
  return `[${items.map((item) => shortNumber(item)).join(", ")}]`;
}

/** A number with six significant digits, in Python notation. */
export function shortNumber(value: number, text = String(value)): string {
  if (Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  if (Number.isInteger(value)) return text;
  return String(Number(value.toPrecision(FIGURES)));
}

function cut(text: string, max: number): string {
  return text.length <= max ? text : `${text.slice(0, max - 1)}…`;
}
