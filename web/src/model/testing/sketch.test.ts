import { expect, test } from "vitest";
import { machineOf } from "../plain_machine.ts";
import { sketch } from "./sketch.ts";

test("a sketch is a document", () => {
  const machine = machineOf(
    sketch(`
      R "Root" hierarchy 0 0 400 300 outcome done
        A "Scan" execution 20 20 80 60 outcome ok output pose:list
        B execution outcome ok input pose:list=[1]
        R > A
        A.ok > B
        B.ok > R.done
        A.pose >> B.pose
    `),
  );
  expect(machine.children("R")).toEqual(["R/A", "R/B"]);
  expect(machine.state("R")?.transitions).toEqual([
    { id: 0, to_state: "A" },
    { id: 1, from_state: "A", from_outcome: 0, to_state: "B" },
    { id: 2, from_state: "B", from_outcome: 0, to_state: "R", to_outcome: 0 },
  ]);
  expect(machine.state("R")?.data_flows).toEqual([
    { id: 0, from_state: "A", from_port: 0, to_state: "B", to_port: 0 },
  ]);
  expect(machine.state("R/B")?.inputs).toEqual([
    { id: 0, name: "pose", data_type: "list", default: [1] },
  ]);
});
