import { expect, test } from "vitest";
import { machineOf } from "../model/plain_machine.ts";
import { sketch } from "../model/testing/sketch.ts";
import { renameElement, renameGlobal, usesInScript } from "./rename_in_script.ts";

const SCRIPT = `def execute(self, inputs, outputs, gvm):
    gvm.set_variable("v", inputs["v"])
    return "ok"
`;

function machine() {
  const document = sketch(`
    R hierarchy input start:str="$v"
      A "Scan" execution outcome ok input v:int
  `);
  const states = document.states.map((state) =>
    state.path === "R/A" ? { ...state, script: SCRIPT } : state,
  );
  return machineOf({ ...document, states });
}

const V = { kind: "input", path: "R/A", id: 0 } as const;

test("a port is renamed with the places in the script that name it", () => {
  expect(usesInScript(machine(), V)).toHaveLength(1);
  expect(renameElement(machine(), V, "speed", true)).toMatchObject({
    edit: {
      edit: "batch",
      edits: [
        { edit: "rename_port", list: "input", port: 0, name: "speed" },
        { edit: "set_script", script: SCRIPT.replace('inputs["v"]', 'inputs["speed"]') },
      ],
    },
  });
  expect(renameElement(machine(), V, "speed", false)).toMatchObject({
    edit: { edit: "rename_port" },
  });
  expect(renameElement(machine(), V, " ", true)).toHaveProperty("refused");
});

test("an outcome is renamed with what the script returns", () => {
  const planned = renameElement(machine(), { kind: "outcome", path: "R/A", id: 0 }, "found", true);
  expect(planned).toMatchObject({
    edit: { edits: [{}, { script: SCRIPT.replace('"ok"', '"found"') }] },
  });
});

test("a global variable is renamed in every script and default", () => {
  expect(renameGlobal(machine(), "v", "velocity")).toMatchObject({
    edit: {
      edits: [
        { edit: "set_script", path: "R/A", script: SCRIPT.replace('("v"', '("velocity"') },
        { edit: "set_port_default", path: "R", default: "$velocity" },
      ],
    },
  });
  expect(renameGlobal(machine(), "unknown", "x")).toHaveProperty("refused");
});
