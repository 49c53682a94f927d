import { expect, test } from "vitest";
import { type ConfirmState, pressed, QUIET, SLIP_MS } from "./confirm_press.ts";

/** What presses at these times do, one after the other: ask, count as the answer, or nothing. */
function check(...times: readonly number[]): string {
  let asked: ConfirmState = QUIET;
  const done = times.map((at) => {
    const before = asked;
    asked = pressed(before, at);
    return before.is === asked.is ? "-" : asked.is;
  });
  return done.join(" ");
}

test("a second press is the answer once the question can have been read", () => {
  expect(check(1_000, 1_000 + SLIP_MS)).toBe("asking answered");
  expect(check(1_000, 2_500)).toBe("asking answered");
});

test("a double press only asks", () => {
  expect(check(1_000, 1_000)).toBe("asking -");
  expect(check(1_000, 1_399)).toBe("asking -");
});

test("who hammers is heard as soon as the question can have been read, and only once", () => {
  expect(check(0, 150, 300, 450, 600, 750, 900, 1_050)).toBe("asking - - answered - - - -");
});

test("after an answer and a rest the next press asks again", () => {
  expect(check(0, 500, 900)).toBe("asking answered asking");
});

test("a press that was made before the question appeared, and comes late, is none", () => {
  expect(pressed({ is: "asking", shown_ms: 900 }, 300)).toEqual({ is: "asking", shown_ms: 900 });
});
