import { expect, test } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { subjectOf } from "./subject.ts";

const MACHINE = machineOf(
  sketch(`
    R hierarchy input speed:int
      A execution outcome ok
      R > A
  `),
);

test("the inspector is about what is selected and still there", () => {
  const of = (...elements: Parameters<typeof subjectOf>[1]) => subjectOf(MACHINE, elements);
  expect(of()).toEqual({ kind: "machine" });
  expect(of({ kind: "state", path: "R/A" })).toEqual({ kind: "state", path: "R/A" });
  expect(of({ kind: "income", path: "R/A" })).toEqual({ kind: "state", path: "R/A" });
  expect(of({ kind: "input", path: "R", id: 0 })).toMatchObject({ kind: "port" });
  expect(of({ kind: "outcome", path: "R/A", id: 0 })).toMatchObject({ kind: "outcome", id: 0 });
  expect(of({ kind: "transition", path: "R", id: 0 })).toMatchObject({ kind: "connection" });
  expect(of({ kind: "state", path: "R/GONE" }, { kind: "state", path: "R" })).toMatchObject({
    kind: "state",
    path: "R",
  });
  expect(of({ kind: "output", path: "R", id: 0 })).toEqual({ kind: "machine" });
  expect(of({ kind: "state", path: "R" }, { kind: "state", path: "R/A" })).toMatchObject({
    kind: "several",
  });
});
