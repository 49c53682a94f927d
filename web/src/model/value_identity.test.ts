import { expect, test } from "vitest";
import type { JsonValue } from "./generated/protocol.ts";
import { parseLiteral } from "./literal.ts";
import { pythonOf } from "./python_of.ts";
import recorded from "./testing/recorded_values.json" with { type: "json" };

/** Text of the page for a value of which only a part was kept. */
const SHORTENED = /\.\.\.|# \d+ characters|an int of \d+ bits|a nested /;

/** One text for each value, whatever its encoding. JSON does not tell `1.0` from `1`. */
function canonical(value: JsonValue): string {
  if (typeof value === "number") return numeric(String(Object.is(value, -0) ? "-0.0" : value));
  if (Array.isArray(value)) return `[${value.map(canonical).join(",")}]`;
  if (typeof value !== "object" || value === null) return JSON.stringify(value);
  const [[tag, inner = null] = ["", null]] = Object.entries(value);
  if (tag === "__int__" || tag === "__float__") return numeric(String(inner));
  if (value["__class__"] === "float") return numeric(String(value["__repr__"]));
  if (tag === "__tuple__") return `(${(inner as JsonValue[]).map(canonical).join(",")})`;
  const pairs = tag === "__dict__" ? (inner as [JsonValue, JsonValue][]) : Object.entries(value);
  const texts = pairs.map(([key, each]) => `${canonical(key)}:${canonical(each ?? null)}`);
  return `{${texts.sort().join(",")}}`;
}

function numeric(text: string): string {
  if (/^-?\d+$/.test(text)) return BigInt(text).toString();
  if (/nan|inf/i.test(text)) return text.toLowerCase().slice(0, 4);
  const value = Number(text);
  if (Object.is(value, -0)) return "-0.0";
  return Number.isInteger(value) ? BigInt(value).toString() : String(value);
}

test("recorded values read back as the same values", () => {
  const values = recorded as readonly JsonValue[];
  expect(values.length).toBeGreaterThan(100);
  const wrong = values.flatMap((value) => {
    const text = pythonOf(value);
    if (SHORTENED.test(text)) return [];
    const back = parseLiteral(text);
    const found = "value" in back ? canonical(back.value) : back.refused;
    return found === canonical(value) ? [] : [{ value, text, found }];
  });
  expect(wrong).toEqual([]);
});

test("what is not all of a value says so", () => {
  for (const [value, text] of [
    [{ __repr__: "an int of 5001 bits", __class__: "int" }, "an int of 5001 bits"],
    [{ __repr__: "b'x", __class__: "bytes", __len__: 300 }, "b'x…"],
    [{ __repr__: "y", __class__: "str", __len__: 300 }, '"y"  # 300 characters'],
    [{ __class__: "dict", __len__: 2, __repr__: "dict of 2", __some__: { a: 1 } }, '{"a": 1, ...}'],
  ] as const) {
    expect(pythonOf(value)).toBe(text);
  }
});

test("keys that are no texts are other keys than texts", () => {
  const value = {
    __dict__: [
      [1, "left"],
      ["1", "right"],
    ],
  };
  expect(pythonOf(value)).toBe('{1: "left", "1": "right"}');
});
