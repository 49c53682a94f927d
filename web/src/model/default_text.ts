/** Default values of ports as people type and read them: Python literals, plain words for texts, `$name` for global variables. */

import type { JsonValue } from "./generated/protocol.ts";
import { type Literal, parseLiteral } from "./literal.ts";
import { shortType } from "./types.ts";
import { python } from "./value.ts";

const GLOBAL = /^\$./;

/** Text of a value in a cell. */
export function textOfDefault(value: JsonValue | undefined): string {
  return typeof value === "string" && GLOBAL.test(value) ? value : python(value ?? null);
}

/** Value of a typed text for a port of this type, or the reason why it is invalid. */
export function readDefault(text: string, type: string): Literal {
  const typed = text.trim();
  if (GLOBAL.test(typed)) return { value: typed };
  const isText = shortType(type) === "str";
  if (typed === "") return { value: isText ? "" : null };
  const literal = parseLiteral(typed);
  if (!isText) return literal;
  const isFitting =
    "value" in literal && (literal.value === null || typeof literal.value === "string");
  return isFitting ? literal : { value: text };
}
