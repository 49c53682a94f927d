import { expect, test } from "vitest";
import type { Moment } from "../../model/generated/protocol.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { portValues } from "./port_values.ts";

const MACHINE = machineOf(
  sketch(`
R hierarchy 0 0 400 300 input speed:int scoped found:list
  A execution 20 20 80 60 output pose:list outcome ok
  B execution 200 20 80 60 input pose:list outcome ok
`),
);

test("what is active has inputs and variables, what ended has outputs; ports that are gone have nothing", () => {
  const active = [
    {
      path: "R",
      inputs: { speed: 3, gone: 1 },
      scoped: { found: [1] },
      ended: [{ path: "R/A", outputs: { pose: [1, 2] } }],
    },
    { path: "R/B", inputs: { pose: [1, 2] }, scoped: {}, ended: [] },
    { path: "R/Gone", inputs: { pose: 1 }, scoped: {}, ended: [] },
  ];
  const found = portValues({ active } as unknown as Moment, MACHINE);
  expect(
    [...found].map(([key, value]) => `${key.replace(/:\d+$/, "")} ${JSON.stringify(value)}`),
  ).toEqual(["input:R 3", "scoped_variable:R [1]", "output:R/A [1,2]", "input:R/B [1,2]"]);
});
