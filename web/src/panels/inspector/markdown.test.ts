// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { withoutHandlers } from "./markdown.ts";

test("handlers are no handlers any more before anything reads them as HTML", () => {
  expect(withoutHandlers('<img src="x" onerror="a()">')).toBe('<img src="x" data-no="a()">');
  expect(withoutHandlers("<svg/onload=a() ONCLICK = b()>")).toBe("<svg/data-no=a() data-no= b()>");
  expect(withoutHandlers("<p>one = 1, on = 2</p>")).toBe("<p>one = 1, on = 2</p>");
});
