import { expect, test } from "vitest";
import type { TextMark } from "../scene/list.ts";
import type { PaintContext } from "./ink.ts";
import { measureWith } from "./measure.ts";
import { LETTERS_MAX, paintTexts } from "./texts.ts";

test("a text of any length is measured and painted to a bounded length", () => {
  const lengths: number[] = [];
  const note = (text: string) => {
    lengths.push(text.length);
    return { width: text.length };
  };
  const rest = { beginPath() {}, roundRect() {}, fill() {} };
  const context = { ...rest, fillText: note, measureText: note } as unknown as PaintContext;
  const text = "x".repeat(1_000_000);
  expect(measureWith(context)(text, 11, false)).toBe(LETTERS_MAX);
  const mark = { text, plate: "ground", ink: "text", alpha: 1, size: 11, x: 0, y: 0, width: 0 };
  paintTexts(context, [{ ...mark, align: "left", bold: false } as unknown as TextMark], {});
  expect(Math.max(...lengths)).toBe(LETTERS_MAX);
});

test("a plate is opaque however faint its text is: it does not half erase what lies below", () => {
  const painted: string[] = [];
  const state: Record<string, unknown> = { globalAlpha: 1 };
  const note = (what: string) => () => painted.push(`${what} at ${state["globalAlpha"]}`);
  const context = new Proxy(state, {
    get: (_, name) =>
      name === "fill" || name === "fillText" ? note(name) : (state[String(name)] ?? (() => {})),
    set: (_, name, value) => {
      state[String(name)] = value;
      return true;
    },
  }) as unknown as PaintContext;
  const text = { text: "done", plate: "ground", ink: "text", alpha: 0.5, size: 11, x: 0, y: 0 };
  const more = { align: "left", bold: false, width: 20 };
  paintTexts(context, [{ ...text, ...more } as unknown as TextMark], {});
  expect(painted).toEqual(["fill at 1", "fillText at 0.5"]);
});
