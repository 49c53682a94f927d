// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { tellMishaps } from "./mishaps.ts";

test("what nothing else catches is said, but for what browsers say of settling layouts", () => {
  const said: string[] = [];
  const stop = tellMishaps({ tell: ({ text }) => said.push(text) }, window);
  const fail = (message: string) =>
    window.dispatchEvent(new ErrorEvent("error", { error: new Error(message) }));
  fail("no such lane");
  fail("ResizeObserver loop completed with undelivered notifications.");
  window.dispatchEvent(
    Object.assign(new Event("unhandledrejection"), { reason: new Error("no file") }),
  );
  stop();
  fail("later");
  expect(said.map((text) => text.split(". ")[0])).toEqual([
    "Error in the page: no such lane",
    "Error in the page: no file",
  ]);
});
