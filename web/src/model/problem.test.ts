import { describe, expect, it } from "vitest";
import type { MachineProblem } from "./generated/protocol.ts";
import { byWeight, countProblems, elementOfProblem, withoutPlace } from "./problem.ts";

const PROBLEM: MachineProblem = {
  path: "R/A",
  part: "state",
  rule: "no_start",
  severity: "error",
  message: "it has no start",
};

describe("problems", () => {
  it("know what they are about", () => {
    const parts = [
      "state",
      "outcome -1",
      "scoped variable 2",
      "data flow 3",
      "runtime value of input 4",
    ];
    const found = parts.map((part) => elementOfProblem({ ...PROBLEM, part }));
    expect(found).toEqual([
      { kind: "state", path: "R/A" },
      { kind: "outcome", path: "R/A", id: -1 },
      { kind: "scoped_variable", path: "R/A", id: 2 },
      { kind: "data_flow", path: "R/A", id: 3 },
      { kind: "input", path: "R/A", id: 4 },
    ]);
  });

  it("say what is wrong without the place", () => {
    const message = "R/A, state: no child is where it starts";
    expect(withoutPlace({ ...PROBLEM, message })).toBe("no child is where it starts");
    expect(withoutPlace(PROBLEM)).toBe("it has no start");
  });

  it("stand by weight, and count without notes", () => {
    const all = (["note", "error", "warning"] as const).map((severity) => ({
      ...PROBLEM,
      severity,
    }));
    expect(byWeight(all).map(({ severity }) => severity)).toEqual(["error", "warning", "note"]);
    expect(countProblems(all)).toBe(2);
  });
});
