import { expect, test } from "vitest";
import { elementOf, keyOf, layoutElement } from "./element.ts";

test("a key leads back to its element", () => {
  for (const element of [
    { kind: "state", path: "A/B" },
    { kind: "income", path: "A" },
    { kind: "outcome", path: "A/B:x", id: -1 },
    { kind: "data_flow", path: "A", id: 3 },
  ] as const) {
    expect(elementOf(keyOf(element))).toEqual(element);
  }
  expect(elementOf("nothing:A")).toBeNull();
  expect(elementOf("outcome:A")).toBeNull();
  expect(layoutElement({ kind: "outcome", path: "A", id: -1 })).toEqual({ outcome: -1 });
});
