// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { counts, focusOf } from "./keyboard.ts";

function inside(html: string): EventTarget | null {
  document.body.innerHTML = html;
  return document.body.querySelector("[data-here]");
}

test("the keyboard is on the canvas, in a text, or elsewhere", () => {
  expect(focusOf(inside(`<div role="application"><canvas data-here></canvas></div>`))).toBe(
    "canvas",
  );
  expect(focusOf(document.body)).toBe("canvas");
  expect(focusOf(inside(`<input data-here>`))).toBe("text");
  expect(focusOf(inside(`<input type="checkbox" data-here>`))).toBe("elsewhere");
  expect(focusOf(inside(`<div contenteditable="true"><b data-here>x</b></div>`))).toBe("text");
  expect(focusOf(inside(`<button data-here></button>`))).toBe("elsewhere");
});

test("letters are for the canvas, undo in a text is the text's", () => {
  expect(counts("E", "canvas")).toBe(true);
  expect(counts("E", "elsewhere")).toBe(false);
  expect(counts("Delete", "elsewhere")).toBe(false);
  expect(counts("Ctrl+Z", "elsewhere")).toBe(true);
  expect(counts("Ctrl+Z", "text")).toBe(false);
  expect(counts("Ctrl+S", "text")).toBe(true);
  expect(counts("F2", "text")).toBe(true);
});
