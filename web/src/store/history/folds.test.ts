import fc from "fast-check";
import { expect, test } from "vitest";
import { Folds } from "./folds.ts";

/** Letters are states: `A B×3 CD×2` is A, three times B, twice C D. */
function folded(text: string, cuts: readonly number[] = []): string {
  const paths = [...text].map((letter) => letter.codePointAt(0) ?? 0);
  const calls = paths.map((_, call) => call);
  const folds = new Folds((call) => paths[call] ?? 0);
  for (const cut of cuts) folds.follow(calls.slice(0, cut));
  folds.follow(calls);
  const letters = (some: readonly number[]) => some.map((call) => text[call]).join("");
  return folds.all
    .map((fold) =>
      fold.kind === "call"
        ? text[fold.call]
        : `${letters(fold.calls.slice(0, fold.period))}×${fold.calls.length / fold.period}`,
    )
    .join(" ");
}

test("what repeats is a loop with its count", () => {
  expect(folded("ABCBCBCD")).toBe("A BC×3 D");
  expect(folded("AAAA")).toBe("A×4");
  expect(folded("ABAB")).toBe("AB×2");
  expect(folded("ABC")).toBe("A B C");
});

test("a round that continues belongs to its loop, until it turns out to be another", () => {
  expect(folded("ABCABCAB")).toBe(`ABC×${8 / 3}`);
  expect(folded("ABCABCABX")).toBe("ABC×2 A B X");
});

test("no call is lost or moved, however the calls are cut", () => {
  const states = fc.string({ unit: fc.constantFrom("A", "B", "C"), maxLength: 60 });
  const cuts = fc.array(fc.nat(60), { maxLength: 8 });
  fc.assert(
    fc.property(states, cuts, (text, some) => {
      const sorted = some.filter((cut) => cut <= text.length).sort((a, b) => a - b);
      expect(folded(text, sorted)).toBe(folded(text));
      const flat = new Folds((call) => text.codePointAt(call) ?? 0);
      flat.follow([...text].map((_, call) => call));
      const all = flat.all.flatMap((fold) => (fold.kind === "call" ? [fold.call] : fold.calls));
      expect(all).toEqual([...text].map((_, call) => call));
    }),
  );
});

test("a round of more than 24 calls is no loop", () => {
  const round = (length: number) =>
    Array.from({ length }, (_, at) => String.fromCodePoint(65 + at)).join("");
  expect(folded(round(24).repeat(2))).toBe(`${round(24)}×2`);
  expect(folded(round(25).repeat(2))).toBe([...round(25).repeat(2)].join(" "));
  expect(folded(`${round(25).repeat(2)}aa`)).toMatch(/ a×2$/);
});
