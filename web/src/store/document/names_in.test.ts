import { expect, test } from "vitest";
import { GoneStates } from "./names_in.ts";

test("a refusal speaks of states by their names, and of who took them away", () => {
  const gone = new GoneStates();
  gone.note("R/MIRJMM", "Serve", "ben");
  const alive = (path: string) => ({ "R/A": "Scan", ROOTID: "Drill" })[path];
  const check = (text: string, expected: string) => expect(gone.named(text, alive)).toBe(expected);
  check(
    "The state R/MIRJMM no longer exists: someone may have removed it.",
    "The state “Serve” no longer exists: ben removed it.",
  );
  check("R/A, state: there is no such outcome", "“Scan”, state: there is no such outcome");
  check("R/MIRJMM: there is no such state", "“Serve”: there is no such state (ben removed it)");
  check("ROOTID, state: ABCDEF is no place", "“Drill”, state: ABCDEF is no place");
  check("nothing of http://a/b is known", "nothing of http://a/b is known");
});
