import { expect, test } from "vitest";
import { completionsAt, type ScriptNames } from "./complete.ts";

const named = (...names: string[]) => names.map((name) => ({ name, detail: "" }));
const NAMES: ScriptNames = {
  inputs: named("speed", "goal"),
  outputs: named("way"),
  outcomes: named("success", "lost"),
  globals: named("in the basket"),
};

/** What would stand in the line for each offer; `|` is the cursor. */
function lines(text: string): readonly string[] {
  const [before = "", after = ""] = text.split("|");
  const found = completionsAt(before, after, NAMES);
  if (!found) return [];
  return found.options.map(
    ({ label, apply }) =>
      before.slice(0, before.length - found.typed.length) +
      (typeof apply === "string" ? apply : label) +
      after,
  );
}

test("ports are offered where they are named", () => {
  expect(lines("x = inputs[|")).toEqual(['x = inputs["speed"', 'x = inputs["goal"']);
  expect(lines('x = inputs["sp|"]')).toEqual(['x = inputs["speed"]', 'x = inputs["goal"]']);
  expect(lines("f(a, inputs.get('|")).toEqual([
    "f(a, inputs.get('speed'",
    "f(a, inputs.get('goal'",
  ]);
  expect(lines("outputs['|'] = 1")).toEqual(["outputs['way'] = 1"]);
  expect(lines('inputs["speed"] + |')).toEqual([]);
});

test("outcomes are offered behind return", () => {
  expect(lines("    return |")).toEqual(['    return "success"', '    return "lost"']);
  expect(lines('    return "l|"')).toEqual(['    return "success"', '    return "lost"']);
  expect(lines('if x: return "lost" if y else "|')).toEqual([
    'if x: return "lost" if y else "success"',
    'if x: return "lost" if y else "lost"',
  ]);
  expect(lines('returned = "|"')).toEqual([]);
});

test("global variables are offered by name", () => {
  expect(lines("gvm.get_variable(|)")).toEqual(['gvm.get_variable("in the basket")']);
  expect(lines('gvm.set_variable("in t|", 1)')).toEqual(['gvm.set_variable("in the basket", 1)']);
});

test("self, its logger, gvm and dialog tell what they have", () => {
  expect(lines("self.pre|")).toContain("self.preempted");
  expect(lines("self.logger.|")).toContain("self.logger.warning");
  expect(lines("gvm.|")).toContain("gvm.set_variable");
  expect(lines("dialog.|")).toContain("dialog.ask");
  expect(lines("other.|")).toEqual([]);
});
