// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { FORMATTED_MAX, formatted, NESTING_MAX, withoutHandlers } from "./markdown.ts";

test("handlers are no handlers any more before anything reads them as HTML", () => {
  expect(withoutHandlers('<img src="x" onerror="a()">')).toBe('<img src="x" data-no="a()">');
  expect(withoutHandlers("<svg/onload=a() ONCLICK = b()>")).toBe("<svg/data-no=a() data-no= b()>");
  expect(withoutHandlers("<p>one = 1, on = 2</p>")).toBe("<p>one = 1, on = 2</p>");
});

const nestedList = (depth: number) =>
  Array.from({ length: depth }, (_, level) => `${"  ".repeat(level)}- item`).join("\n");

test.each([
  ["quotations", ">".repeat(30_000)],
  ["list items", nestedList(3_000)],
  ["emphasis", `${"*a _b ".repeat(200)}${" c_ d*".repeat(200)}`],
])("%s are nested to a bounded depth, and all of a short text is there", (_, text) => {
  const { html, isTooDeep } = formatted(text);
  const opened = [...html.matchAll(/<(blockquote|ul|em|strong)>/g)].length;
  expect(isTooDeep).toBe(true);
  expect(opened).toBeGreaterThan(1);
  expect(opened).toBeLessThanOrEqual(NESTING_MAX);
});

test("the beginning of a long text is formatted, to the end of a line", () => {
  const line = "A *word* of many.\n";
  const { html, length, isTooDeep } = formatted(line.repeat(60_000));
  expect(length).toBeLessThanOrEqual(FORMATTED_MAX);
  expect((length + 1) % line.length).toBe(0);
  expect(html.match(/<em>/g)?.length).toBe((length + 1) / line.length);
  expect(isTooDeep).toBe(false);
});

test("a text of usual length and depth is formatted whole", () => {
  const text = "1. **One** `two`\n   - > three\n\n| a |\n| - |\n| b |";
  expect(formatted(text)).toMatchObject({ length: text.length, isTooDeep: false });
  expect(formatted(text).html).toContain("<blockquote>");
});
