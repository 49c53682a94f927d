import { expect, test } from "vitest";
import { cut, wrapped } from "./words.ts";

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
