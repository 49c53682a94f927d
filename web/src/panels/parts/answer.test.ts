import { describe, expect, it } from "vitest";
import type { Form, Question } from "../../model/generated/protocol.ts";
import {
  answerInWords,
  answerOf,
  deadlineInWords,
  firstFilled,
  refusalOfFilled,
} from "./answer.ts";

const BUTTONS = ["OK", "Cancel"];
const NUMBER: Form = {
  type: "number",
  buttons: BUTTONS,
  minimum: 1,
  maximum: 9.5,
  initial: 2,
  whole: true,
};
const CHECKS: Form = {
  type: "checks",
  buttons: BUTTONS,
  boxes: ["left", "right"],
  initial: [false],
};
const TEXT: Form = { type: "text", buttons: BUTTONS, initial: "bay 3" };

describe("an answer", () => {
  it("begins with what the state proposes", () => {
    const first = (form: Form) => answerOf(form, firstFilled(form), 0);
    expect(first({ type: "buttons", buttons: ["yes"] })).toEqual({ button: 0 });
    expect(first(TEXT)).toEqual({ button: 0, text: "bay 3" });
    expect(first(NUMBER)).toEqual({ button: 0, number: 2 });
    expect(first(CHECKS)).toEqual({ button: 0, checked: [false, false] });
  });

  it("is refused where the robot would refuse it", () => {
    const refusal = (text: string) => refusalOfFilled(NUMBER, { text, checked: [] });
    expect(["", "x", "0", "10", "1.5", "9"].map(refusal)).toEqual([
      "Enter a number.",
      "Enter a number.",
      "0 is too small; the minimum is 1.",
      "10 is too large; the maximum is 9.5.",
      "1.5 is not a whole number.",
      null,
    ]);
  });

  it("may be cancelled with nothing filled in", () => {
    const none: Form = { ...NUMBER, initial: null };
    expect(answerOf(none, { text: "", checked: [] }, 1)).toEqual({ button: 1, number: 1 });
  });

  it("is read as words", () => {
    expect(answerInWords(CHECKS, { button: 0, checked: [true, true] })).toBe("OK: left, right");
    expect(answerInWords(TEXT, { button: 1, text: "" })).toBe("Cancel: “”");
    const question = { form: NUMBER, default: { button: 0, number: 3 } } as unknown as Question;
    expect(deadlineInWords(question)).toBe("then “OK: 3” is used");
    expect(deadlineInWords({ ...question, default: null })).toBe("then the state fails");
  });
});
