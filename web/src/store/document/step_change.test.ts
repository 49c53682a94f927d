import { describe, expect, it } from "vitest";
import { differences } from "../../model/difference.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { OptimisticDocument } from "./optimistic_document.ts";
import { StepChanges, stepChangeOf } from "./step_change.ts";

const TEXT = `
  R hierarchy outcome done
    A "Scan" execution outcome ok
    B "Grip" hierarchy outcome ok
      C execution
    A.ok > B`;

describe("the trace of a step", () => {
  it("says what was changed, in words, whatever is changed later", () => {
    const machine = new OptimisticDocument(sketch(TEXT), () => undefined);
    const earlier = machine.confirm([
      { change: "state", state: { path: "R/A", name: "Look", kind: "execution" } },
      { change: "transition", path: "R", id: 0 },
    ]);
    const stepChange = stepChangeOf(earlier, machine);
    machine.confirm([{ change: "state_removed", path: "R/A" }]);
    const found = differences(stepChange.before, stepChange.after);
    expect(found.map(({ kind, name }) => `${kind} ${name}`)).toEqual([
      "removed Scan.ok → Grip",
      "changed Look",
      "removed preempted",
      "removed aborted",
      "removed ok",
    ]);
  });

  it("is given up when there are too many", () => {
    const machine = new OptimisticDocument(sketch(TEXT), () => undefined);
    const changes = new StepChanges();
    for (let revision = 1; revision <= 201; revision += 1) {
      changes.put(revision, stepChangeOf(new Map(), machine));
    }
    expect([changes.get(1), changes.get(2) === undefined]).toEqual([undefined, false]);
  });

  it("has the names of the first 300 children of a container", () => {
    const names = Array.from({ length: 301 }, (_, at) => `    S${1_000 + at} execution`);
    const machine = new OptimisticDocument(
      sketch(["", "  R hierarchy", ...names].join("\n")),
      () => undefined,
    );
    const { after } = stepChangeOf(new Map([["R", machine.state("R")]]), machine);
    expect(after.children("R").length).toBe(300);
    const last = machine.children("R").at(-1) ?? "";
    const changed = stepChangeOf(new Map([[last, machine.state(last)]]), machine);
    expect(changed.after.state(last)?.name).toBe(machine.state(last)?.name);
  });
});
