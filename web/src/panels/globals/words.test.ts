import { expect, test } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { countsInWords, found, placeInWords } from "./words.ts";

test("a filter finds names with all its words", () => {
  const variables = ["in the basket", "In the gripper", "battery"].map((name) => ({
    name,
    uses: [],
  }));
  const names = (query: string) => found(variables, query).map(({ name }) => name);
  expect(names("THE in")).toEqual(["in the basket", "In the gripper"]);
  expect(names(" ")).toHaveLength(3);
  expect(names("x")).toEqual([]);
});

test("a place is told in words", () => {
  const machine = machineOf(sketch('R "Root" hierarchy\n  A "Scan" execution'));
  const use = { path: "R/A", access: "set", line: 3, text: "gvm.set_variable(…)" } as const;
  expect(placeInWords(machine, use)).toBe("set Scan:3 gvm.set_variable(…)");
  expect(placeInWords(machine, { ...use, line: null })).toBe("set Scan gvm.set_variable(…)");
  const read = { ...use, access: "read" } as const;
  expect(countsInWords({ name: "v", uses: [use, read, read] })).toBe("set once, read 2 times");
  expect(countsInWords({ name: "v", uses: [read] })).toBe("never set, read once");
});
