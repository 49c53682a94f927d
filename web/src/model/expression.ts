/** Expressions of watches: `value`, its parts by `.x` and `[0]`, `len()` and simple arithmetic, in Python syntax. They are parsed
 * and evaluated here, never executed as a program. */

import {
  callFunction,
  FUNCTIONS,
  isTrue,
  memberOf,
  numberIn,
  partOf,
  WrongValue,
} from "./expression_values.ts";
import type { JsonValue } from "./generated/protocol.ts";
import { isSame } from "./json.ts";

export interface Expression {
  /** Evaluates the expression for a value, or returns the reason why it cannot. */
  readonly of: (value: unknown) => Worked;
}

type Worked = { readonly value: JsonValue } | { readonly refused: string };

/** Name of the watched value in expressions. */
const NAME = "value";

const LENGTH_MAX = 500;

type Evaluate = (value: JsonValue) => JsonValue;

/** Parses an expression. Returns the error and its position if it is invalid. */
export function readExpression(text: string): Expression | { readonly refused: string } {
  try {
    const reader = new ExpressionReader(text);
    const node = reader.all();
    return { of: (value) => worked(node, value as JsonValue) };
  } catch (error) {
    if (error instanceof WrongValue) return { refused: error.message };
    throw error;
  }
}

function worked(node: Evaluate, value: JsonValue): Worked {
  try {
    return { value: node(value) };
  } catch (error) {
    if (error instanceof WrongValue) return { refused: error.message };
    throw error;
  }
}

const TOKEN =
  /\s*(?:(\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|\.\d+)|("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')|([A-Za-z_]\w*)|(\*\*|\/\/|[<>=!]=|[-+*/%<>()[\].,]))/y;

interface Token {
  readonly kind: "number" | "text" | "word" | "sign" | "end";
  readonly text: string;
  readonly at: number;
}

type Two = (one: JsonValue, other: JsonValue) => JsonValue;

const numbers =
  (work: (one: number, other: number) => number): Two =>
  (one, other) =>
    work(numberIn(one), numberIn(other));
const compared =
  (test: (one: number, other: number) => boolean): Two =>
  (one, other) =>
    test(numberIn(one), numberIn(other));

/** Binary operators in ascending precedence. */
const BETWEEN: readonly Readonly<Record<string, Two>>[] = [
  {
    "==": (one, other) => isSame(one, other),
    "!=": (one, other) => !isSame(one, other),
    "<": compared((one, other) => one < other),
    "<=": compared((one, other) => one <= other),
    ">": compared((one, other) => one > other),
    ">=": compared((one, other) => one >= other),
  },
  { "+": numbers((one, other) => one + other), "-": numbers((one, other) => one - other) },
  {
    "*": numbers((one, other) => one * other),
    "/": numbers(divided),
    "//": numbers((one, other) => Math.floor(divided(one, other))),
    "%": numbers((one, other) => one - other * Math.floor(divided(one, other))),
  },
];

function divided(one: number, other: number): number {
  if (other === 0) throw new WrongValue("division by zero");
  return one / other;
}

class ExpressionReader {
  readonly #tokens: readonly Token[];
  #at = 0;

  constructor(text: string) {
    this.#tokens = tokensOf(text);
  }

  all(): Evaluate {
    const node = this.#either();
    if (this.#next().kind !== "end") this.#fail();
    return node;
  }

  #next(): Token {
    return this.#tokens[this.#at] ?? { kind: "end", text: "", at: 0 };
  }

  #take(text: string): boolean {
    const { kind, text: found } = this.#next();
    const isIt = (kind === "sign" || kind === "word") && found === text;
    if (isIt) this.#at += 1;
    return isIt;
  }

  #want(text: string): void {
    if (!this.#take(text)) this.#fail(`${text} is missing`);
  }

  #fail(why?: string): never {
    const { kind, text, at } = this.#next();
    const found = kind === "end" ? "the expression is incomplete" : `${text} does not fit here`;
    throw new WrongValue(`${why ?? found} (at character ${at + 1})`);
  }

  #either(): Evaluate {
    const one = this.#both();
    if (!this.#take("or")) return one;
    const other = this.#either();
    return (value) => {
      const first = one(value);
      return isTrue(first) ? first : other(value);
    };
  }

  #both(): Evaluate {
    const one = this.#not();
    if (!this.#take("and")) return one;
    const other = this.#both();
    return (value) => {
      const first = one(value);
      return isTrue(first) ? other(value) : first;
    };
  }

  #not(): Evaluate {
    if (!this.#take("not")) return this.#between(0);
    const inner = this.#not();
    return (value) => !isTrue(inner(value));
  }

  #between(level: number): Evaluate {
    const signs = BETWEEN[level];
    if (!signs) return this.#signed();
    let node = this.#between(level + 1);
    for (let two = this.#sign(signs); two; two = this.#sign(signs)) {
      const [one, other, work] = [node, this.#between(level + 1), two];
      node = (value) => work(one(value), other(value));
    }
    return node;
  }

  #sign(signs: Readonly<Record<string, Two>>): Two | undefined {
    const { kind, text } = this.#next();
    const found = kind === "sign" && Object.hasOwn(signs, text) ? signs[text] : undefined;
    if (found) this.#at += 1;
    return found;
  }

  #signed(): Evaluate {
    if (this.#take("-")) {
      const inner = this.#signed();
      return (value) => -numberIn(inner(value));
    }
    if (this.#take("+")) return this.#signed();
    const base = this.#parts();
    if (!this.#take("**")) return base;
    const power = this.#signed();
    return (value) => numberIn(base(value)) ** numberIn(power(value));
  }

  /** A value followed by any number of members and indices. */
  #parts(): Evaluate {
    let node = this.#one();
    for (;;) {
      const inner = node;
      if (this.#take(".")) {
        const { kind, text } = this.#next();
        if (kind !== "word") this.#fail("a name is missing after the point");
        this.#at += 1;
        node = (value) => memberOf(inner(value), text);
      } else if (this.#take("[")) {
        const key = this.#either();
        this.#want("]");
        node = (value) => partOf(inner(value), key(value));
      } else return node;
    }
  }

  #one(): Evaluate {
    const { kind, text } = this.#next();
    if (this.#take("(")) {
      const node = this.#either();
      this.#want(")");
      return node;
    }
    if (kind === "number" || kind === "text") {
      this.#at += 1;
      const literal = kind === "number" ? Number(text) : unquoted(text);
      return () => literal;
    }
    if (kind === "word") return this.#word(text);
    return this.#fail();
  }

  #word(word: string): Evaluate {
    if (word === "and" || word === "or") return this.#fail();
    this.#at += 1;
    if (word === NAME) return (value) => value;
    if (word === "True") return () => true;
    if (word === "False") return () => false;
    if (word === "None") return () => null;
    if (!FUNCTIONS.includes(word)) {
      this.#at -= 1;
      return this.#fail(
        `${word} is unknown: use ${NAME}, or one of the functions ${FUNCTIONS.join(", ")}`,
      );
    }
    this.#want("(");
    const values: Evaluate[] = [];
    while (!this.#take(")")) {
      values.push(this.#either());
      if (!this.#take(",") && this.#next().text !== ")") this.#fail(") is missing");
    }
    return (value) =>
      callFunction(
        word,
        values.map((node) => node(value)),
      );
  }
}

function tokensOf(text: string): readonly Token[] {
  if (text.length > LENGTH_MAX)
    throw new WrongValue(`an expression can have at most ${LENGTH_MAX} characters`);
  const tokens: Token[] = [];
  const end = text.trimEnd().length;
  TOKEN.lastIndex = 0;
  for (let at = 0; at < end; at = TOKEN.lastIndex) {
    TOKEN.lastIndex = at;
    const found = TOKEN.exec(text);
    if (!found)
      throw new WrongValue(
        `${text.slice(at).trim()[0]} does not fit here (at character ${at + 1})`,
      );
    const [whole, number, quoted, word, sign] = found;
    const kind = number ? "number" : quoted ? "text" : word ? "word" : "sign";
    const content = number ?? quoted ?? word ?? sign ?? "";
    tokens.push({ kind, text: content, at: at + whole.length - content.length });
  }
  return [...tokens, { kind: "end", text: "", at: end }];
}

function unquoted(text: string): string {
  return text.slice(1, -1).replaceAll(/\\(.)/g, "$1");
}
