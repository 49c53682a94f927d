import { expect, test } from "vitest";
import { clipOf, pasteClip } from "./clipboard.ts";
import { partsOf, pasteParts } from "./parts.ts";
import { isRefused } from "./plan.ts";
import { drawn, lines, made, reason } from "./testing/plans.ts";

const machine = drawn(`
  R hierarchy 0 0 400 300 outcome done input speed:float=0.5 scoped found:list
    A "Scan" execution 20 20 80 60 outcome ok outcome lost input speed:float=2.0 output pose:list
    B "Go" execution 200 20 80 60 outcome ok input pose:str
    R > A
`);

const POSE = { kind: "output", path: "R/A", id: 1 } as const;
const SPEED = { kind: "input", path: "R/A", id: 0 } as const;
const LOST = { kind: "outcome", path: "R/A", id: 1 } as const;

test("ports and outcomes are pasted under names that are free", () => {
  const parts = partsOf(machine, [SPEED, POSE, LOST]);
  expect(lines(pasteParts(machine, "R/A", parts))).toEqual([
    "add_port R/A list=input port=2 name=speed_0 data_type=float default=2",
    "add_port R/A list=output port=3 name=pose_0 data_type=list default=null",
    "add_outcome R/A outcome=2 name=lost_0",
  ]);
  expect(made(pasteParts(machine, "R/A", parts)).select).toEqual([
    { kind: "input", path: "R/A", id: 2 },
    { kind: "output", path: "R/A", id: 3 },
    { kind: "outcome", path: "R/A", id: 2 },
  ]);
});

test("ports become those of the table in which they are pasted", () => {
  const parts = partsOf(machine, [SPEED, POSE, LOST]);
  expect(lines(pasteParts(machine, "R", parts, "scoped_variable"))).toEqual([
    "add_port R list=scoped_variable port=2 name=speed data_type=float default=2",
    "add_port R list=scoped_variable port=3 name=pose data_type=list default=null",
  ]);
  expect(lines(pasteParts(machine, "R/B", parts, "outcome"))).toEqual([
    "add_outcome R/B outcome=1 name=lost",
  ]);
  const ports = partsOf(machine, [SPEED]);
  expect(reason(pasteParts(machine, "R/B", ports, "outcome"))).toContain("only ports");
  expect(reason(pasteParts(machine, "R/B", ports.slice(1)))).toContain("copy them first");
});

test("an execution state takes ports and outcomes, and no scoped variables", () => {
  const found = { kind: "scoped_variable", path: "R", id: 1 } as const;
  const parts = partsOf(machine, [found]);
  expect(reason(pasteParts(machine, "R/B", parts))).toContain("only containers");
  expect(lines(pasteParts(machine, "R/B", parts, "input"))[0]).toContain("list=input port=1");
  const clip = clipOf(machine, [
    { kind: "state", path: "R/A" },
    { ...found },
    { ...SPEED, path: "R" },
  ]);
  if (isRefused(clip)) throw new Error(clip.refused);
  expect(clip.parts.map(({ kind }) => kind)).toEqual(["input"]);
  const goal = { container: { path: "R" }, owner: "R/B" };
  expect(lines(pasteClip(machine, clip, goal))).toEqual([
    "add_port R/B list=input port=1 name=speed data_type=float default=0.5",
  ]);
  const whole = lines(pasteClip(machine, clip, { ...goal, owner: "R" }));
  expect(whole.map((line) => line.split(" ")[0])).toEqual(["add_port", "paste"]);
});

test("an income, aborted and preempted are not copied", () => {
  const aborted = { kind: "outcome", path: "R/A", id: -1 } as const;
  expect(reason(clipOf(machine, [{ kind: "income", path: "R/A" }, aborted]))).toContain(
    "own outcomes",
  );
});
