import { expect, test } from "vitest";
import type { ElementRef } from "../../model/element.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import type { MarkPhase, RunMark } from "../../store/run/marks.ts";
import { ARM } from "../testing/driver.ts";
import { described, type Signs, urgentWords } from "./describe.ts";

const machine = machineOf(sketch(ARM));

test("a name of any length is said to a bounded length", () => {
  const long = machineOf(sketch(`R "${"x".repeat(100_000)}" hierarchy`));
  expect(described(long, { kind: "state", path: "R" })).toHaveLength(2_001);
});

test("elements are said in words", () => {
  const say = (element: ElementRef) => described(machine, element);
  expect(say({ kind: "state", path: "R/A" })).toBe(
    "Scan, execution state, start state, 2 outcomes, leads to Grasp",
  );
  expect(say({ kind: "state", path: "R/B" })).toBe(
    "Grasp, execution state, 1 outcome, leads to outcome done of Root",
  );
  expect(say({ kind: "state", path: "R/C" })).toBe("Box, hierarchy, 1 state, 1 outcome");
  expect(say({ kind: "outcome", path: "R/A", id: 1 })).toBe("outcome lost of Scan");
  expect(say({ kind: "input", path: "R/B", id: 0 })).toBe("input pose of Grasp, type int");
  expect(say({ kind: "income", path: "R/B" })).toBe("income of Grasp");
  expect(say({ kind: "transition", path: "R", id: 1 })).toBe("transition Scan.ok → Grasp");
  const run = { phase: "waiting", failed: true, detail: "an answer" } as RunMark;
  expect(described(machine, { kind: "state", path: "R/C" }, { run })).toBe(
    "Box, waits for an answer, failed before, hierarchy, 1 state, 1 outcome",
  );
  expect(say({ kind: "state", path: "R/X" })).toBe("no longer exists");
});

test("a state says what it does in a run, and its breakpoint", () => {
  const say = (signs: Signs) =>
    described(machine, { kind: "state", path: "R/C" }, signs).split(", hierarchy")[0];
  const phase = (name: MarkPhase) => ({ phase: name, failed: false, detail: null }) as RunMark;
  expect(say({ run: phase("running") })).toBe("Box, runs");
  expect(say({ run: phase("held"), breakpoint: "on" })).toBe("Box, is paused, breakpoint");
  expect(say({ run: phase("failed") })).toBe("Box, failed");
  expect(say({ breakpoint: "off" })).toBe("Box, breakpoint off");
});

test("what someone may want to know at once is said without being asked for", () => {
  const say = (phase: MarkPhase, detail: string | null = null) =>
    urgentWords(machine, "R/C", { run: { phase, failed: false, detail } as RunMark });
  expect(say("waiting", "an answer")).toBe("Box waits for an answer");
  expect(say("held")).toBe("Box is paused");
  expect(say("next")).toBe("Box comes next");
  expect(say("running")).toBe("");
  expect(urgentWords(machine, "R/C", { breakpoint: "on" })).toBe("");
});
