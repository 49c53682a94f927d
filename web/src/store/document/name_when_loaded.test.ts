import { expect, test } from "vitest";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { nameWhenLoaded } from "./name_when_loaded.ts";

const OUTER = 'R hierarchy\n  L "Arm" library library=lib/arm';
const WHOLE = `R hierarchy
  L "Arm" hierarchy
    G hierarchy
      C "Close the gripper" execution`;

/** A machine that loads one library at a time. */
function session(...stages: readonly string[]) {
  const machines = stages.map((text) => machineOf(sketch(text)));
  const asked: string[] = [];
  const machine = { state: (path: string) => machines[asked.length]?.state(path) };
  const loadLibrary = async (path: string) => {
    if (asked.length < machines.length - 1) asked.push(path);
  };
  return { machine, loadLibrary, asked };
}

test("a state in a library has its name once the library is here", async () => {
  const here = session(OUTER, WHOLE);
  expect(await nameWhenLoaded(here, "R/L/G/C")).toBe("Close the gripper");
  expect(here.asked).toEqual(["R/L"]);
});

test("a state that no library brings is called by its id", async () => {
  expect(await nameWhenLoaded(session(OUTER), "R/L/G/C")).toBe("C");
  expect(await nameWhenLoaded(session(WHOLE), "R/X")).toBe("X");
});
