import { expect, test } from "vitest";
import { compared } from "./once.ts";

const entered = (sequence: number, path = "ROOT") => ({ sequence, kind: "entered", path });

test("what was told once is no difference, nor is what the page has forgotten", () => {
  const journal = [entered(1), { sequence: 3, kind: "log", path: "" }];
  expect(compared(journal, journal)).toEqual([]);
  expect(compared([entered(1), { sequence: 3, kind: "", path: "" }], journal)).toEqual([]);
});

test("what is missing, twice, another or too much is told", () => {
  const page = [entered(1), entered(1), entered(2, "ROOT/B"), entered(5)];
  expect(compared(page, [entered(1), entered(2, "ROOT/A"), entered(4)])).toEqual([
    "event 1 was received twice",
    "event 2 is entered ROOT/B instead of entered ROOT/A",
    "event 4 is missing: entered ROOT",
    "event 5 never was: entered ROOT",
  ]);
});
