/** Python types of ports: compatibility between them, and of values with them. Only built-in types are known. */

import type { JsonValue } from "./generated/protocol.ts";

const BUILTIN = [
  "NoneType",
  "bool",
  "int",
  "float",
  "str",
  "list",
  "tuple",
  "dict",
  "set",
  "object",
] as const;

type Builtin = (typeof BUILTIN)[number];

/** Types that are suggested first. */
export const COMMON_TYPES: readonly string[] = [
  "int",
  "float",
  "str",
  "bool",
  "list",
  "dict",
  "tuple",
  "set",
  "object",
];

/** Short name of a type: `int` for `builtins.int`. */
export function shortType(name: string): string {
  const short = name.trim().replace(/^(__builtin__|builtins)\./, "");
  return short === "None" ? "NoneType" : short;
}

function isBuiltin(name: string): name is Builtin {
  return (BUILTIN as readonly string[]).includes(name);
}

/** True if the text is a valid name of a type: `int`, `numpy.ndarray`. */
export function isTypeName(text: string): boolean {
  return /^[\p{L}_][\p{L}\p{N}_]*(\.[\p{L}_][\p{L}\p{N}_]*)*$/u.test(text.trim());
}

/** True if values may flow from a port of type `source` to one of type `target`; false only if that is certainly wrong. */
export function fits(source: string, target: string): boolean {
  const [from, to] = [shortType(source), shortType(target)];
  if (from === to || from === "object" || to === "object") return true;
  if (!isBuiltin(from) || !isBuiltin(to)) return true;
  return from === "bool" && to === "int";
}

/** Default value of a new port of this type. */
export function defaultOf(type: string): JsonValue {
  switch (shortType(type)) {
    case "int":
      return 0;
    case "float":
      return { __float__: "0.0" };
    case "bool":
      return false;
    case "str":
      return "";
    case "list":
      return [];
    case "dict":
      return {};
    case "tuple":
      return { __tuple__: [] };
    case "set":
      return { __set__: [] };
    default:
      return null;
  }
}

/** Built-in type of a value; null if only Python can determine it. */
export function typeOf(value: JsonValue): string | null {
  if (value === null) return "NoneType";
  if (typeof value === "boolean") return "bool";
  if (typeof value === "number") return Number.isInteger(value) ? "int" : "float";
  if (typeof value === "string") return "str";
  if (Array.isArray(value)) return "list";
  const [only, ...more] = Object.keys(value);
  if (only === undefined || more.length > 0) return "dict";
  return MARKED[only] === undefined ? "dict" : MARKED[only];
}

const MARKED: Readonly<Record<string, string | null>> = {
  __int__: "int",
  __float__: "float",
  __tuple__: "tuple",
  __set__: "set",
  __dict__: "dict",
  __type__: "type",
  __object__: null,
};

/** True if the value can be the default of a port. A text is parsed when a run starts; `$name` is a global variable. */
export function valueFits(value: JsonValue, type: string): boolean {
  const wanted = shortType(type);
  const found = typeOf(value);
  if (typeof value === "string" && wanted !== "str") return textFits(value, wanted);
  if (value === null || found === null || found === wanted) return true;
  if (wanted === "object" || wanted === "NoneType" || !isBuiltin(wanted)) return true;
  return found === "bool" && wanted === "int";
}

const BRACKETS: Readonly<Record<string, readonly [string, string]>> = {
  list: ["[", "]"],
  tuple: ["(", ")"],
  dict: ["{", "}"],
};

/** True if Python is expected to convert the text to the type. */
function textFits(text: string, type: string): boolean {
  if (text === "None" || /^\$./.test(text)) return true;
  const plain = text.trim();
  if (type === "int") return /^[-+]?\d+(_\d+)*$/.test(plain);
  if (type === "float") {
    return /^[-+]?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|inf|infinity|nan)$/i.test(plain);
  }
  if (type === "bool") return /^(True|False|None|[-+]?\d+(\.\d*)?)$/.test(plain);
  const brackets = BRACKETS[type];
  return !brackets || (plain.startsWith(brackets[0]) && plain.endsWith(brackets[1]));
}
