import { expect, test } from "vitest";
import { cut, wrapped, wrappedName } from "./words.ts";

/** Every letter six wide. */
const measure = (text: string) => text.length * 6;

test("texts are broken between words and behind underscores, and keep all their letters", () => {
  expect(wrapped("Look for the part", 60, 3, 11, measure)).toEqual(["Look for", "the part"]);
  expect(wrapped("look_for_the_part", 60, 3, 11, measure)).toEqual(["look_for_", "the_part"]);
  expect(wrapped("one two three four five six", 60, 2, 11, measure)).toEqual([
    "one two",
    "three fou…",
  ]);
});

test("a word that is too long for a line is broken if all of the name has room then", () => {
  expect(wrappedName("Relocalise", 48, 3, 11, measure)).toEqual(["Relocal-", "ise"]);
  expect(wrappedName("Charge", 24, 3, 11, measure)).toEqual(["Cha-", "rge"]);
  expect(wrappedName("Remember it", 36, 3, 11, measure)).toEqual(["Remem-", "ber it"]);
  expect(wrappedName("Charge", 24, 1, 11, measure)).toEqual(["Cha…"]);
  expect(wrappedName("Waypoint 12", 24, 3, 11, measure)).toEqual(["Way…", "12"]);
  expect(wrappedName("Charge", 12, 3, 11, measure)).toEqual([]);
  expect(wrapped("0x7fffdeadbeef", 48, 3, 11, measure)).toEqual(["0x7fffd…"]);
});

test("the number at the end of a name stays: it is what tells it from others", () => {
  expect(cut("Waypoint 12", 48, 11, false, measure)).toBe("Wayp… 12");
  expect(cut("Look around", 48, 11, false, measure)).toBe("Look ar…");
  expect(cut("Waypoint 12", 24, 11, false, measure)).toBe("Way…");
});

test("of a name of any length only its beginning is measured", () => {
  const long = `${"a word ".repeat(200_000)}12`;
  let longest = 0;
  const noted = (text: string) => {
    longest = Math.max(longest, text.length);
    return text.length * 6;
  };
  expect(cut(long, 60, 11, false, noted)).toBe("a word… 12");
  expect(wrapped(long, 60, 2, 11, noted)).toHaveLength(2);
  expect(longest).toBeLessThan(1_100);
});
