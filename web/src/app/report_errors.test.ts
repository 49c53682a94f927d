// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { reportErrors } from "./report_errors.ts";

test("what nothing else catches is said, but for what browsers say of settling layouts", () => {
  const reported: string[] = [];
  const stop = reportErrors({ tell: ({ text }) => reported.push(text) }, window);
  const fail = (message: string) =>
    window.dispatchEvent(new ErrorEvent("error", { error: new Error(message) }));
  fail("no such lane");
  fail("ResizeObserver loop completed with undelivered notifications.");
  window.dispatchEvent(
    Object.assign(new Event("unhandledrejection"), { reason: new Error("no file") }),
  );
  stop();
  fail("later");
  expect(reported.map((text) => text.split(". ")[0])).toEqual([
    "Error in the page: no such lane",
    "Error in the page: no file",
  ]);
});
