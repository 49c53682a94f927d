/** Parses Python literals to wire values; `python` of value.ts is the inverse. */

import type { JsonValue } from "./generated/protocol.ts";

export type Literal = { readonly value: JsonValue } | { readonly refused: string };

/** Value of a Python literal, or the error with its position. */
export function parseLiteral(text: string): Literal {
  const reader = new LiteralReader(text);
  try {
    reader.space();
    if (reader.atEnd()) return { refused: "the value is empty: write None for no value" };
    const value = reader.value(0);
    reader.space();
    if (!reader.atEnd()) reader.fail("unexpected text after the value");
    return { value };
  } catch (error) {
    if (error instanceof NoLiteral) return { refused: error.message };
    throw error;
  }
}

class NoLiteral extends Error {}

const DEPTH_MAX = 96;
const NUMBER =
  /(?:0[xX][\da-fA-F](?:_?[\da-fA-F])*|0[oO][0-7](?:_?[0-7])*|0[bB][01](?:_?[01])*)|(?:\d(?:_?\d)*\.?(?:\d(?:_?\d)*)?|\.\d(?:_?\d)*)(?:[eE][-+]?\d(?:_?\d)*)?/y;
const WORD = /[\p{L}_][\p{L}\p{N}_.]*/uy;
const TYPES = new Set([
  "int",
  "float",
  "bool",
  "str",
  "list",
  "dict",
  "tuple",
  "set",
  "object",
  "bytes",
  "type",
]);
const HINTS: Readonly<Record<string, string>> = { true: "True", false: "False", null: "None" };
const ESCAPES: Readonly<Record<string, string>> = {
  n: "\n",
  t: "\t",
  r: "\r",
  a: "\x07",
  b: "\b",
  f: "\f",
  v: "\v",
  "\\": "\\",
  "'": "'",
  '"': '"',
  "\n": "",
};

class LiteralReader {
  readonly #text: string;
  #at = 0;

  constructor(text: string) {
    this.#text = text;
  }

  atEnd(): boolean {
    return this.#at >= this.#text.length;
  }

  fail(what: string): never {
    throw new NoLiteral(`${what} (at character ${this.#at + 1})`);
  }

  space(): void {
    while (/[\s#]/.test(this.#next())) {
      if (this.#next() === "#") this.#skipComment();
      else this.#at++;
    }
  }

  value(depth: number): JsonValue {
    if (depth > DEPTH_MAX) this.fail(`values can be nested at most ${DEPTH_MAX} levels deep`);
    const next = this.#next();
    switch (next) {
      case "[":
        return this.#items("]", depth).items;
      case "(":
        return this.#inParentheses(depth);
      case "{":
        return this.#inBraces(depth);
      case "'":
      case '"':
        return this.#texts();
      case "-":
      case "+":
        return this.#signed();
    }
    if (/[\d.]/.test(next)) return this.#number("");
    return this.#word(depth);
  }

  #next(): string {
    return this.#text.charAt(this.#at);
  }

  #take(token: string): boolean {
    const found = this.#text.startsWith(token, this.#at);
    if (found) this.#at += token.length;
    return found;
  }

  #match(pattern: RegExp): string {
    pattern.lastIndex = this.#at;
    const found = pattern.exec(this.#text)?.[0] ?? "";
    this.#at += found.length;
    return found;
  }

  #skipComment(): void {
    const end = this.#text.indexOf("\n", this.#at);
    this.#at = end < 0 ? this.#text.length : end;
  }

  #items(close: string, depth: number): { items: JsonValue[]; comma: boolean } {
    this.#at++;
    const items: JsonValue[] = [];
    let comma = true;
    for (this.space(); !this.#take(close); this.space()) {
      if (!comma) this.fail(`a comma or ${close} is missing`);
      if (this.atEnd()) this.fail(`${close} is missing`);
      items.push(this.value(depth + 1));
      this.space();
      comma = this.#take(",");
    }
    return { items, comma: comma && items.length > 0 };
  }

  #inParentheses(depth: number): JsonValue {
    const { items, comma } = this.#items(")", depth);
    const [only] = items;
    return items.length === 1 && !comma && only !== undefined ? only : { __tuple__: items };
  }

  #inBraces(depth: number): JsonValue {
    this.#at++;
    this.space();
    if (this.#take("}")) return {};
    const pairs: [JsonValue, JsonValue][] = [];
    const items: JsonValue[] = [];
    let comma = true;
    for (; !this.#take("}"); this.space()) {
      if (!comma) this.fail("a comma or } is missing");
      if (this.atEnd()) this.fail("} is missing");
      const first = this.value(depth + 1);
      this.space();
      if (this.#take(":")) {
        this.space();
        pairs.push([first, this.value(depth + 1)]);
      } else items.push(first);
      if (pairs.length > 0 && items.length > 0) this.fail("a key without a value");
      this.space();
      comma = this.#take(",");
      this.space();
    }
    return items.length > 0 ? { __set__: items } : dictionary(pairs);
  }

  /** Adjacent strings are one string, as in Python. */
  #texts(): string {
    let text = "";
    while (/['"]/.test(this.#next())) {
      text += this.#string(false);
      this.space();
    }
    return text;
  }

  #string(raw: boolean): string {
    const mark = this.#next();
    const quote = this.#take(mark.repeat(3)) ? mark.repeat(3) : mark;
    if (quote.length === 1) this.#at++;
    let text = "";
    while (!this.#take(quote)) {
      if (this.atEnd() || (quote.length === 1 && this.#next() === "\n")) {
        this.fail(`the text does not end: ${quote} is missing`);
      }
      if (this.#next() === "\\" && !raw) text += this.#escape();
      else text += this.#text.charAt(this.#at++);
    }
    return text;
  }

  #escape(): string {
    this.#at++;
    const letter = this.#text.charAt(this.#at++);
    const known = ESCAPES[letter];
    if (known !== undefined) return known;
    const length = { x: 2, u: 4, U: 8 }[letter];
    if (length === undefined) return this.#octal(letter);
    const digits = this.#text.slice(this.#at, this.#at + length);
    const code = Number.parseInt(digits, 16);
    if (!/^[\da-fA-F]+$/.test(digits) || digits.length < length || code > 0x10ffff) {
      this.fail(`\\${letter} needs ${length} hexadecimal digits`);
    }
    this.#at += length;
    return String.fromCodePoint(code);
  }

  #octal(letter: string): string {
    if (!/[0-7]/.test(letter)) return `\\${letter}`;
    const more = this.#match(/[0-7]{0,2}/y);
    return String.fromCodePoint(Number.parseInt(letter + more, 8));
  }

  #signed(): JsonValue {
    const sign = this.#next() === "-" ? "-" : "";
    this.#at++;
    this.space();
    if (/[\d.]/.test(this.#next())) return this.#number(sign);
    const word = this.#match(WORD);
    if (word === "inf" || word === "nan") return special(sign, word);
    return this.fail("a number is missing after the sign");
  }

  #number(sign: string): JsonValue {
    const found = this.#match(NUMBER).replaceAll("_", "");
    if (found === "" || found === ".") this.fail("this is not a number");
    if (/[jJ]/.test(this.#next())) this.fail("complex numbers are not supported");
    if (/[\p{L}\d_]/u.test(this.#next())) this.fail("this is not a number");
    const isWhole = /^0[xob]/i.test(found) || !/[.e]/i.test(found);
    if (isWhole) return this.#whole(sign, found);
    const value = Number(sign + found);
    if (!Number.isFinite(value)) return special(sign, "inf");
    if (!Number.isInteger(value) && Math.abs(value) < 2 ** 53) return value;
    return { __float__: shown(value) };
  }

  #whole(sign: string, digits: string): JsonValue {
    if (/^0\d*[1-9]/.test(digits)) this.fail("a whole number cannot start with 0");
    const value = BigInt(digits) * (sign === "" ? 1n : -1n);
    const safe = BigInt(Number.MAX_SAFE_INTEGER);
    return value >= -safe && value <= safe ? Number(value) : { __int__: String(value) };
  }

  #word(depth: number): JsonValue {
    const word = this.#match(WORD);
    if (/^[rRuU]$/.test(word) && /['"]/.test(this.#next())) return this.#string(/r/i.test(word));
    if (word === "True") return true;
    if (word === "False") return false;
    if (word === "None") return null;
    if (word === "inf" || word === "nan") return special("", word);
    this.space();
    if (this.#next() === "(") return this.#call(word, depth);
    const hint = HINTS[word];
    if (hint !== undefined) this.fail(`Python writes ${hint} for ${word}`);
    if (TYPES.has(word)) return { __type__: `builtins.${word}` };
    if (word === "") return this.fail("a value is missing");
    return this.fail(`${word} is not a value: put it in quotes if it is text`);
  }

  #call(word: string, depth: number): JsonValue {
    const { items } = this.#items(")", depth);
    const [argument] = items;
    if (word === "set" && items.length === 0) return { __set__: [] };
    if (word === "set" && Array.isArray(argument)) return { __set__: argument };
    if (word === "float" && typeof argument === "string") {
      const found = /^([-+]?)(nan|inf)(inity)?$/i.exec(argument.trim());
      if (found) return special(found[1] === "-" ? "-" : "", (found[2] ?? "").toLowerCase());
    }
    return this.fail(`${word}(…) is not a literal: write the value itself`);
  }
}

function special(sign: string, word: string): JsonValue {
  return { __float__: word === "nan" ? "NaN" : `${sign}inf` };
}

/** A float without a fraction in Python notation. */
function shown(value: number): string {
  if (Object.is(value, -0)) return "-0.0";
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}

/** A dict, marked as one where a plain object would change it. */
function dictionary(pairs: readonly [JsonValue, JsonValue][]): JsonValue {
  const isPlain = pairs.every(
    ([key]) => typeof key === "string" && !key.startsWith("__") && !/^\d+$/.test(key),
  );
  if (!isPlain) return { __dict__: [...unique(pairs)] };
  return Object.fromEntries(pairs as [string, JsonValue][]);
}

/** Keeps the last value of a repeated key, as in Python. */
function unique(pairs: readonly [JsonValue, JsonValue][]): [JsonValue, JsonValue][] {
  const byKey = new Map(pairs.map((pair) => [JSON.stringify(pair[0]), pair]));
  return [...byKey.values()];
}
