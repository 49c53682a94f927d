import { expect, test } from "vitest";
import type { JsonValue } from "./generated/protocol.ts";
import {
  semanticRows,
  textOf,
  valueOfText,
  withKey,
  withNewKey,
  withoutKey,
  withValue,
} from "./semantic.ts";

const DATA: JsonValue = { author: "Ada", limits: { speed: 1.5, names: ["a"] }, empty: {} };

function shown(data: JsonValue | null, folded: ReadonlySet<string> = new Set()): readonly string[] {
  return semanticRows(data, folded).map(
    ({ keys, text, size }) =>
      `${"  ".repeat(keys.length - 1)}${keys.at(-1)} ${text ?? `{${size}}`}`,
  );
}

test("semantic data are shown as a tree", () => {
  expect(shown(DATA)).toEqual([
    "author Ada",
    "limits {2}",
    "  speed 1.5",
    '  names ["a"]',
    "empty {0}",
  ]);
  expect(shown(DATA, new Set(['["limits"]']))).toEqual(["author Ada", "limits {2}", "empty {0}"]);
  expect(shown(null)).toEqual([]);
});

test("values, keys and rows change at any depth", () => {
  expect(withValue(DATA, ["limits", "speed"], 2)).toEqual({
    ...DATA,
    limits: { speed: 2, names: ["a"] },
  });
  expect(withoutKey(DATA, ["limits", "names"])).toMatchObject({ limits: { speed: 1.5 } });
  expect(withoutKey(DATA, ["author"])).toEqual({ limits: DATA["limits"], empty: {} });
  expect(withKey(DATA, ["limits", "speed"], "v")).toMatchObject({ data: { limits: { v: 1.5 } } });
  expect(withKey(DATA, ["author"], "limits")).toHaveProperty("refused");
  expect(withKey(DATA, ["author"], " ")).toHaveProperty("refused");
  expect(withNewKey(DATA, ["empty"], "")).toMatchObject({ data: { empty: { key: "" } } });
  expect(withNewKey({ key: 1 }, [], {})).toEqual({ data: { key: 1, key_1: {} }, keys: ["key_1"] });
  expect(withNewKey(null, [], "x").data).toEqual({ key: "x" });
});

test("keys that JavaScript would move or take for marks are marked", () => {
  const named = withKey({ a: 1, b: 2 }, ["b"], "1");
  expect(named).toEqual({
    data: {
      __dict__: [
        ["a", 1],
        ["1", 2],
      ],
    },
  });
  expect("data" in named && shown(named.data)).toEqual(["a 1", "1 2"]);
  expect(shown({ big: { __int__: "9007199254740993" } })).toEqual(["big 9007199254740993"]);
});

test("what is shown is read as the same value", () => {
  const values: JsonValue[] = [
    "hello",
    "5",
    "None",
    "[1]",
    " x ",
    "",
    5,
    1.5,
    null,
    true,
    [1, "a"],
    "a\nb",
  ];
  for (const value of values) expect(valueOfText(textOf(value))).toEqual(value);
});
