import { describe, expect, it } from "vitest";
import { differences } from "../model/difference.ts";
import { sketch } from "../model/sketch.ts";
import { Mirror } from "./mirror.ts";
import { Traces, traceOf } from "./trace.ts";

const TEXT = `
  R hierarchy outcome done
    A "Scan" execution outcome ok
    B "Grip" hierarchy outcome ok
      C execution
    A.ok > B`;

describe("the trace of a step", () => {
  it("says what was changed, in words, whatever is changed later", () => {
    const machine = new Mirror(sketch(TEXT), () => undefined);
    const earlier = machine.confirm([
      { change: "state", state: { path: "R/A", name: "Look", kind: "execution" } },
      { change: "transition", path: "R", id: 0 },
    ]);
    const trace = traceOf(earlier, machine);
    machine.confirm([{ change: "state_removed", path: "R/A" }]);
    const found = differences(trace.before, trace.after);
    expect(found.map(({ kind, name }) => `${kind} ${name}`)).toEqual([
      "removed Scan.ok → Grip",
      "changed Look",
      "removed preempted",
      "removed aborted",
      "removed ok",
    ]);
  });

  it("is given up when there are too many", () => {
    const machine = new Mirror(sketch(TEXT), () => undefined);
    const traces = new Traces();
    for (let revision = 1; revision <= 201; revision += 1) {
      traces.put(revision, traceOf(new Map(), machine));
    }
    expect([traces.get(1), traces.get(2) === undefined]).toEqual([undefined, false]);
  });
});
