import { describe, expect, it } from "vitest";
import type { Machine } from "../../model/machine.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { OptimisticDocument } from "./optimistic_document.ts";

const OWN = `
  R hierarchy outcome done
    L library library=tools/gripper
    X execution`;
const GRIPPER = `
  GRIP hierarchy outcome ok
    A execution
    IN library library=tools/finger`;
const FINGER = `
  F execution outcome ok`;

function setUp() {
  const contents = new Map<string, Machine>([["tools/gripper", machineOf(sketch(GRIPPER))]]);
  return { contents, machine: new OptimisticDocument(sketch(OWN), (key) => contents.get(key)) };
}

describe("the content of libraries", () => {
  it("stands below the library state, to any depth", () => {
    const { contents, machine } = setUp();
    contents.set("tools/finger", machineOf(sketch(FINGER)));
    expect(machine.children("R/L")).toEqual(["R/L/GRIP"]);
    expect(machine.children("R/L/GRIP")).toEqual(["R/L/GRIP/A", "R/L/GRIP/IN"]);
    expect(machine.children("R/L/GRIP/IN")).toEqual(["R/L/GRIP/IN/F"]);
    expect(machine.state("R/L/GRIP/IN/F")?.kind).toBe("execution");
    expect(machine.isInLibrary("R/L/GRIP/A")).toBe(true);
    expect(machine.isInLibrary("R/L")).toBe(false);
    expect(machine.isInLibrary("R/L/NOWHERE")).toBe(false);
    expect(machine.state("R/X/GRIP")).toBeUndefined();
    expect([...machine.paths()]).toEqual(["R", "R/L", "R/X"]);
  });

  it("is there once it has come", () => {
    const { contents, machine } = setUp();
    expect(machine.children("R/L/GRIP/IN")).toEqual([]);
    const before = machine.version;
    contents.set("tools/finger", machineOf(sketch(FINGER)));
    machine.libraryChanged();
    expect(machine.children("R/L/GRIP/IN")).toEqual(["R/L/GRIP/IN/F"]);
    expect(machine.version).toBeGreaterThan(before);
  });

  it("goes with the library state", () => {
    const { machine } = setUp();
    expect(machine.state("R/L/GRIP/A")).toBeDefined();
    machine.transact(() => machine.confirm([{ change: "state_removed", path: "R/L" }]));
    expect(machine.state("R/L/GRIP/A")).toBeUndefined();
  });
});
