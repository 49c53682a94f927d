import { expect, test } from "vitest";
import { readLayout } from "../model/layout_reader.ts";
import {
  addOutcome,
  addPort,
  renamePort,
  setPortType,
  setRuntimeValue,
  useRuntimeValue,
} from "./ports.ts";
import {
  addLibrary,
  addState,
  changeKind,
  removeElements,
  rename,
  setId,
  setStart,
} from "./states.ts";
import { drawn, editsOf, lines, made, reason } from "./testing/plans.ts";

const machine = drawn(`
  R "Root" hierarchy 0 0 100 100 outcome done scoped found:list
    A "Scan" execution outcome ok output pose:list=[1] output count:int
    B "Grasp" execution outcome ok input pose:list
    L "Lib" library library=arm/grasp input speed:float
    R > A
    A.ok > B
    A.pose >> B.pose
`);

test("a state comes with a script and an outcome, its middle at the point", () => {
  const plan = made(addState(machine, "R", "execution", { x: 50, y: 80 }));
  const edits = plan.edit.edit === "batch" ? plan.edit.edits : [plan.edit];
  const added = edits.at(-1);
  const [state] = added?.edit === "add_state" ? added.states : [];
  expect(state?.path).toMatch(/^[A-Z]{6}$/);
  expect(state && readLayout(state)).toMatchObject({
    position: { x: 40, y: 70 },
    size: { width: 20, height: 20 },
  });
  expect(plan.select).toEqual([{ kind: "state", path: `R/${state?.path}` }]);
  expect(state?.script).toContain("def execute");
});

test("those that stand where no one put them stay there when others come", () => {
  const edits = lines(addState(machine, "R", "execution"));
  expect(edits.slice(0, 2)).toEqual([
    "set_position R/A element=state position=[4,12]",
    "set_size R/A element=state size=[20,20]",
  ]);
});

test("the first state of a hierarchy is its start", () => {
  const empty = drawn("R hierarchy outcome done");
  const edits = editsOf(addState(empty, "R", "hierarchy"));
  expect(edits.map(({ edit }) => edit)).toEqual(["add_state", "set_start"]);
  expect(reason(addState(machine, "R/A", "execution"))).toBe(
    "Scan is an execution state and cannot contain states: make it a hierarchy first.",
  );
});

test("a library state has the ports and the form of its library", () => {
  const [root] = drawn("G hierarchy 0 0 200 100 outcome ok input speed:int").paths();
  const library = drawn("G hierarchy 0 0 200 100 outcome ok input speed:int").state(root ?? "");
  if (!library) throw new Error("no library");
  const edits = editsOf(
    addLibrary(machine, "R", { path: "arm", name: "grasp" }, library, { x: 50, y: 50 }),
  );
  const last = edits.at(-1);
  const [state] = last?.edit === "add_state" ? last.states : [];
  expect(state?.inputs).toHaveLength(1);
  expect(state && readLayout(state).size).toEqual({ width: 20, height: 10 });
});

test("connections go before their ends, and what cannot go says why", () => {
  const edits = lines(
    removeElements(machine, [
      { kind: "state", path: "R/B" },
      { kind: "transition", path: "R", id: 1 },
      { kind: "input", path: "R/B", id: 0 },
    ]),
  );
  expect(edits.filter((line) => line.startsWith("remove"))).toEqual([
    "remove_transition R transition=1",
    "remove_state R state=B",
  ]);
  expect(reason(removeElements(machine, [{ kind: "outcome", path: "R/A", id: -1 }]))).toContain(
    "outcome of every state",
  );
  expect(reason(removeElements(machine, [{ kind: "state", path: "R" }]))).toContain("root");
  expect(reason(removeElements(machine, [{ kind: "input", path: "R/L", id: 0 }]))).toContain(
    "library",
  );
});

test("names, ids and kinds", () => {
  expect(lines(rename(machine, "R/A", " Look "))).toEqual(["set_name R/A name=Look"]);
  expect(reason(rename(machine, "R/A", "a/b"))).toContain("a slash");
  expect(made(setId(machine, "R/A", "LOOK")).select).toEqual([{ kind: "state", path: "R/LOOK" }]);
  expect(reason(setId(machine, "R/A", "B"))).toContain("a different one");
  expect(lines(setStart(machine, "R/B"))).toEqual(['set_start R to={"state":"B"}']);
  expect(lines(changeKind(machine, "R/A", "barrier"))).toEqual(["set_kind R/A kind=barrier"]);
  expect(reason(changeKind(machine, "R/L", "hierarchy"))).toContain("library");
});

test("new ports and outcomes have names and ids that are free", () => {
  expect(lines(addOutcome(machine, "R/A"))).toEqual(["add_outcome R/A outcome=1 name=success"]);
  expect(lines(addPort(machine, "R/A", "output"))).toEqual([
    "add_port R/A list=output port=2 name=output_0 data_type=int default=0",
  ]);
  expect(reason(addPort(machine, "R/A", "scoped_variable"))).toContain("containers");
  expect(reason(addPort(machine, "R/L", "input"))).toContain("library");
  expect(reason(renamePort(machine, { kind: "output", path: "R/A", id: 0 }, "count"))).toBe(
    "Another output has the name count: choose a different one.",
  );
});

test("a default that no longer fits becomes the one of the new type", () => {
  expect(
    lines(setPortType(machine, { kind: "scoped_variable", path: "R", id: 0 }, "dict")),
  ).toEqual(["set_port_type R list=scoped_variable port=0 data_type=dict"]);
  const [, second] = lines(setPortType(machine, { kind: "output", path: "R/A", id: 0 }, "object"));
  expect(second).toBeUndefined();
  expect(reason(setPortType(machine, { kind: "output", path: "R/A", id: 0 }, "int"))).toContain(
    "Grasp.pose of the type list",
  );
});

test("what a library gets at its ports", () => {
  const speed = { kind: "input", path: "R/L", id: 0 } as const;
  expect(lines(setRuntimeValue(machine, speed, { __float__: "2.0" }))).toEqual([
    'set_runtime_value R/L list=input port=0 value={"__float__":"2.0"}',
  ]);
  expect(reason(setRuntimeValue(machine, speed, "fast"))).toContain("not of the type float");
  expect(lines(useRuntimeValue(machine, speed, true))).toEqual([
    "set_runtime_value R/L list=input port=0 value=null",
  ]);
});

test("a barrier comes with a decider that has a body to begin with", () => {
  const machine = drawn("R hierarchy 0 0 400 300 outcome done");
  const edits = editsOf(addState(machine, "R", "barrier"));
  const script = edits.find((edit) => edit.edit === "set_script");
  expect(script?.path).toMatch(/^R\/[A-Z]+\/unique_decider_state_id$/);
  expect(script?.script).toContain("def execute(self, inputs, outputs, gvm):");
});
