import { expect, test } from "vitest";
import type { StateDocument } from "./generated/protocol.ts";
import { globalsOf } from "./globals.ts";
import { machineOf } from "./plain_machine.ts";
import { sketch } from "./testing/sketch.ts";

function scripted(states: readonly StateDocument[], scripts: Record<string, string>) {
  return states.map((state) => {
    const script = scripts[state.path];
    return script === undefined ? state : { ...state, script };
  });
}

test("global variables are listed with where they are set and read", () => {
  const document = sketch(`
    R hierarchy input where:str="$place"
      A execution
      L library=generic/move
  `);
  const states = scripted(document.states, {
    "R/A": `def execute(self, inputs, outputs, gvm):
    gvm.set_variable("place", "kitchen")
    return gvm.get_variable("answer")
`,
  });
  const [content] = scripted(sketch("M execution").states, {
    M: 'def execute(self, i, o, g):\n    g.get_variable("place")\n',
  });
  const plain = machineOf({ ...document, states });
  const machine = {
    ...plain,
    state: (path: string) => (path === "R/L/M" ? content : plain.state(path)),
    children: (path: string) => (path === "R/L" ? ["R/L/M"] : plain.children(path)),
  };
  expect(globalsOf(machine)).toEqual([
    {
      name: "answer",
      uses: [{ path: "R/A", access: "read", line: 3, text: 'return gvm.get_variable("answer")' }],
    },
    {
      name: "place",
      uses: [
        { path: "R", access: "read", line: null, text: "default of input where" },
        { path: "R/A", access: "set", line: 2, text: 'gvm.set_variable("place", "kitchen")' },
        { path: "R/L/M", access: "read", line: 2, text: 'g.get_variable("place")' },
      ],
    },
  ]);
});
