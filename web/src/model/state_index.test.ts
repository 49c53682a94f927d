import { expect, test } from "vitest";
import { machineOf } from "./plain_machine.ts";
import { stateIndex } from "./state_index.ts";
import { sketch } from "./testing/sketch.ts";

const MACHINE = machineOf(
  sketch(`
    R "Drill four holes" hierarchy outcome done
      A "Move to wheel" hierarchy outcome ok
        B "Turn 4" execution outcome ok
      C "Wheels 4" execution outcome ok
      D "Unload sample" execution outcome ok
      E "Freewheel" execution outcome ok
  `),
);

function check(query: string, expected: string): void {
  const found = stateIndex(MACHINE).find(query, 10);
  expect(found.map(({ path }) => path.split("/").at(-1)).join(" ")).toBe(expected);
}

test("states are found by their names: those that begin so first, then where a word does, then anywhere", () => {
  check("wheel", "C A E B");
  check("WHEELS 4", "C");
});

test("words may also stand in the names of the states around", () => {
  check("wheel turn", "B");
  check("drill unload", "D");
});

test("letters in order find what no word does", () => {
  check("unlsam", "D");
  check("xyz", "");
});

test("the index is another one when the machine is", () => {
  const machine = { ...MACHINE, version: 1 };
  expect(stateIndex(machine)).toBe(stateIndex(machine));
  const before = stateIndex(machine);
  Object.assign(machine, { version: 2 });
  expect(stateIndex(machine)).not.toBe(before);
});
