import fc from "fast-check";
import { expect, test } from "vitest";
import { compareSteps } from "./step_difference.ts";

const SIGNS = { kept: " ", added: "+", removed: "-" } as const;

function compared(before: string, now: string): string {
  const steps = (text: string) => [...text].map((action) => ({ action, objects: ["x"] }));
  return compareSteps(steps(before), steps(now))
    .map(({ step, difference }) => `${SIGNS[difference]}${step.action}`)
    .join("");
}

test("what stays, comes and goes is told in one order", () => {
  expect(compared("abc", "abc")).toBe(" a b c");
  expect(compared("", "ab")).toBe("+a+b");
  expect(compared("ab", "")).toBe("-a-b");
  expect(compared("abcd", "axcd")).toBe(" a-b+x c d");
  expect(compared("abc", "xabcy")).toBe("+x a b c+y");
  expect(compared("gdgu", "gu")).toBe(" g-d-g u");
});

test("names count without their case", () => {
  const one = compareSteps([{ action: "go", objects: ["A"] }], [{ action: "GO", objects: ["a"] }]);
  expect(one.map(({ difference }) => difference)).toEqual(["kept"]);
});

test("both answers can be read from the difference, whatever they are", () => {
  const steps = fc.array(fc.constantFrom("a", "b", "c", "d"), { maxLength: 12 });
  fc.assert(
    fc.property(steps, steps, (before, now) => {
      const rows = compareSteps(
        before.map((action) => ({ action, objects: [] })),
        now.map((action) => ({ action, objects: [] })),
      );
      const read = (without: string) =>
        rows.filter(({ difference }) => difference !== without).map(({ step }) => step.action);
      expect(read("removed")).toEqual(now);
      expect(read("added")).toEqual(before);
      expect(
        rows.filter(({ difference }) => difference !== "removed").map((row) => row.index),
      ).toEqual(now.map((_, index) => index));
    }),
  );
});
