import { expect, test } from "vitest";
import { newBreakpoint } from "../../store/run/breakpoints.ts";
import { breakpointInWords } from "./words.ts";

test("a breakpoint says what is not as ever", () => {
  const plain = newBreakpoint(1, "R/A");
  expect(breakpointInWords(plain)).toBe("before");
  expect(breakpointInWords({ ...plain, when: "after", hit_count: 3, scope: "run" })).toBe(
    "after, from the 3rd time on, pauses the whole run",
  );
  expect(breakpointInWords({ ...plain, hit_count: 12, unattended: "continue" })).toBe(
    "before, from the 12th time on, continues while nobody is connected",
  );
  expect(breakpointInWords({ ...plain, unattended: "stop", lost_link_ms: 90_000 })).toBe(
    "before, stops the run while nobody is connected or the ground is silent for 90 s",
  );
});
