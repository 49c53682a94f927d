/** Classifies wire values (docs/protocol.md, values; docs/edits.md, values) in one place for all views. */

import type { JsonValue } from "./generated/protocol.ts";
import { python } from "./value.ts";

/** A classified value. `count` is the original size, which exceeds the kept data if the value was cut. */
export type Read =
  | { readonly kind: "none" }
  | { readonly kind: "bool"; readonly value: boolean }
  | {
      readonly kind: "number";
      readonly value: number;
      readonly text: string;
      /** `number`: a whole number that may be an int, or a float without a fraction. */
      readonly of: "int" | "float" | "number";
    }
  | { readonly kind: "text"; readonly text: string; readonly count: number }
  | {
      readonly kind: "list";
      readonly of: "list" | "tuple" | "set";
      readonly items: readonly JsonValue[];
      readonly count: number;
    }
  | {
      readonly kind: "dict";
      /** Entries by key label. Labels are Python literals if not all keys are texts: `1` and `"1"` are different keys. */
      readonly entries: readonly (readonly [string, JsonValue])[];
      readonly hasLiteralKeys: boolean;
      readonly count: number;
    }
  | ReadArray
  | { readonly kind: "error"; readonly of: string; readonly message: string }
  | { readonly kind: "type"; readonly name: string }
  | { readonly kind: "object"; readonly of: string; readonly shown: string };

export interface ReadArray {
  readonly kind: "array";
  readonly of: string;
  readonly dtype: string;
  readonly shape: readonly number[];
  /** Printed form. */
  readonly shown: string;
  /** Its numbers row by row, or an evenly spaced sample; null if none were kept. */
  readonly items: readonly number[] | null;
  /** Number of kept numbers along each axis, and the step between them. */
  readonly sampled: readonly number[];
  readonly steps: readonly number[];
}

type Members = Readonly<Record<string, JsonValue>>;

const SPECIAL = /^[-+]?(nan|inf(inity)?)$/i;

/** Classifies a value. Every input has a result. */
export function read(value: unknown): Read {
  if (value === null || value === undefined) return { kind: "none" };
  if (typeof value === "boolean") return { kind: "bool", value };
  if (typeof value === "number") return number(value);
  if (typeof value === "string") return { kind: "text", text: value, count: [...value].length };
  if (Array.isArray(value)) return { kind: "list", of: "list", items: value, count: value.length };
  return marked(value as Members);
}

function number(value: number): Read {
  return {
    kind: "number",
    value,
    text: String(value),
    of: Number.isInteger(value) ? "number" : "float",
  };
}

function marked(members: Members): Read {
  const text = (key: string) => {
    const found = members[key];
    return typeof found === "string" ? found : undefined;
  };
  const error = text("__exc__");
  if (error !== undefined) return { kind: "error", of: error, message: text("msg") ?? "" };
  const name = text("__type__");
  if (name !== undefined)
    return { kind: "type", name: name.replace(/^(__builtin__|builtins)\./, "") };
  for (const of of ["tuple", "set"] as const) {
    const items = members[`__${of}__`];
    if (Array.isArray(items)) return { kind: "list", of, items, count: items.length };
  }
  const special = text("__float__") ?? text("__int__");
  if (special !== undefined)
    return written(special, text("__int__") === undefined ? "float" : "int");
  const shown = text("__repr__");
  if (shown !== undefined) return represented(members, shown, text("__class__") ?? "");
  return dict(members);
}

function written(text: string, of: "int" | "float"): Read {
  return { kind: "number", value: numberOf(text), text, of };
}

/** Parses a number in Python or JSON notation; NaN for other text. */
function numberOf(text: string): number {
  const plain = text.toLowerCase().replace(/^\+/, "");
  if (!SPECIAL.test(plain)) return Number(plain);
  if (plain.includes("nan")) return Number.NaN;
  return plain.startsWith("-") ? Number.NEGATIVE_INFINITY : Number.POSITIVE_INFINITY;
}

/** A value that was cut, or that has no encoding of its own. */
function represented(members: Members, shown: string, of: string): Read {
  const length = members["__len__"];
  const count = typeof length === "number" ? length : 0;
  const first = members["__first__"];
  if (Array.isArray(first)) {
    return { kind: "list", of: of === "tuple" ? "tuple" : "list", items: first, count };
  }
  const some = members["__some__"];
  if (isObject(some)) return { ...dict(some), count };
  if (of === "str" && typeof length === "number") return { kind: "text", text: shown, count };
  if (isNumber(shown, of)) return written(shown, of);
  const shape = numbers(members["__shape__"]);
  const isCut = typeof length === "number";
  return shape
    ? array(members, shown, of, shape)
    : { kind: "object", of, shown: isCut ? `${shown}…` : shown };
}

/** True if the printed form is a whole number or a special float. An integer that is too long is only described. */
function isNumber(shown: string, of: string): of is "int" | "float" {
  return (of === "int" && /^-?\d+$/.test(shown)) || (of === "float" && SPECIAL.test(shown));
}

function array(members: Members, shown: string, of: string, shape: readonly number[]): Read {
  const sampled = numbers(members["__sampled__"]) ?? shape;
  const kept = members["__items__"];
  const items = Array.isArray(kept) ? kept.map(itemOf) : null;
  const isWhole = items?.length === sampled.reduce((all, each) => all * each, 1);
  return {
    kind: "array",
    of,
    dtype: String(members["__dtype__"] ?? ""),
    shape,
    shown,
    items: isWhole ? items : null,
    sampled,
    steps: numbers(members["__steps__"]) ?? shape.map(() => 1),
  };
}

function itemOf(item: JsonValue): number {
  const found = read(item);
  if (found.kind === "number") return found.value;
  return found.kind === "bool" ? Number(found.value) : Number.NaN;
}

function dict(members: Members): Extract<Read, { kind: "dict" }> {
  const pairs = members["__dict__"];
  if (!Array.isArray(pairs)) {
    const entries = Object.entries(members);
    return { kind: "dict", entries, hasLiteralKeys: false, count: entries.length };
  }
  const entries = pairs.flatMap((pair) =>
    Array.isArray(pair) ? [[keyLabel(pair[0] ?? null), pair[1] ?? null] as const] : [],
  );
  return { kind: "dict", entries, hasLiteralKeys: true, count: entries.length };
}

/** A key as a Python literal, or in its printed form. */
export function keyLabel(key: JsonValue): string {
  const shown = isObject(key) ? key["__repr__"] : undefined;
  return typeof shown === "string" ? shown : python(key);
}

function numbers(value: JsonValue | undefined): readonly number[] | null {
  return Array.isArray(value) && value.every((each) => typeof each === "number")
    ? (value as number[])
    : null;
}

function isObject(value: JsonValue | undefined): value is { [key in string]: JsonValue } {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** Type of a value with its size: `list ⟨3⟩`, `float64 ⟨480×640⟩`, `str`. */
export function typeWords(found: Read): string {
  switch (found.kind) {
    case "none":
      return "None";
    case "bool":
      return "bool";
    case "number":
      return found.of;
    case "text":
      return found.count > 40 ? `str ⟨${found.count}⟩` : "str";
    case "list":
      return `${found.of} ⟨${found.count}⟩`;
    case "dict":
      return `dict ⟨${found.count}⟩`;
    case "array":
      return `${found.dtype || found.of} ⟨${found.shape.join("×")}⟩`;
    case "error":
      return found.of;
    case "type":
      return "type";
    case "object":
      return found.of || "object";
  }
}
