import fc from "fast-check";
import { expect, test } from "vitest";
import type { ElementRef } from "../model/element.ts";
import {
  checkConnect,
  connect,
  connectFromSibling,
  connectToParent,
  connectToSibling,
  connectToState,
  reconnect,
} from "./connect.ts";
import { insertState } from "./insert.ts";
import { drawn, editsOf, lines, reason } from "./testing/plans.ts";

const machine = drawn(`
  R "Root" hierarchy 0 0 400 300 outcome done scoped found:list input speed:int
    A "Scan" execution 20 20 80 60 outcome ok outcome lost output pose:list
    B "Grasp" execution 200 20 80 60 outcome ok input pose:list input force:float
    C "Inner" hierarchy 20 120 160 120 outcome out input given:list
      D "Deep" execution 10 10 50 40 outcome ok input pose:list output result:list scoped
      E "Other" execution 80 10 50 40 outcome ok
      C > E
    P "Both" preemptive 200 120 160 120 outcome out
      X execution 10 10 50 40 outcome ok
      Y execution 80 10 50 40 outcome ok
    L "Lib" library 20 250 40 40 library=arm/grasp input pose:list
    R > A
    A.ok > B
`);

const outcome = (path: string, id: number): ElementRef => ({ kind: "outcome", path, id });
const income = (path: string): ElementRef => ({ kind: "income", path });
const input = (path: string, id: number): ElementRef => ({ kind: "input", path, id });
const output = (path: string, id: number): ElementRef => ({ kind: "output", path, id });
const scoped = (path: string, id: number): ElementRef => ({ kind: "scoped_variable", path, id });
const state = (path: string): ElementRef => ({ kind: "state", path });

test("an outcome leads to a sibling, whichever end was drawn first", () => {
  const edit = 'add_transition R transition=2 from={"state":"B","outcome":0} to={"state":"A"}';
  expect(lines(connect(machine, outcome("R/B", 0), income("R/A")))).toEqual([edit]);
  expect(lines(connect(machine, income("R/A"), outcome("R/B", 0)))).toEqual([edit]);
  expect(lines(connect(machine, outcome("R/B", 0), state("R/A")))).toEqual([edit]);
});

test("an outcome leads out of the container, and the income to its start", () => {
  expect(lines(connect(machine, outcome("R/B", 0), outcome("R", 0)))).toEqual([
    'add_transition R transition=2 from={"state":"B","outcome":0} to={"outcome":0}',
  ]);
  expect(lines(connect(machine, income("R"), income("R/B")))).toEqual([
    'set_start R to={"state":"B"}',
  ]);
});

test("an outcome leads to one place", () => {
  expect(reason(connect(machine, outcome("R/A", 0), income("R/C")))).toBe(
    "Scan.ok already leads to Grasp: drag the end of that transition elsewhere, or delete it first.",
  );
});

test("concurrency states have their own ways", () => {
  expect(reason(checkConnect(machine, outcome("R/P/X", 0), income("R/P/Y")))).toContain("at once");
  expect(reason(checkConnect(machine, income("R/P"), income("R/P/Y")))).toContain("no start");
  expect(checkConnect(machine, outcome("R/P/X", 0), outcome("R/P", 0))).toBe(true);
});

test("a transition leads out through the outcomes between", () => {
  expect(lines(connect(machine, outcome("R/C/D", 0), income("R/B")))).toEqual([
    "add_outcome R/C outcome=1 name=ok",
    'add_transition R/C transition=1 from={"state":"D","outcome":0} to={"outcome":1}',
    'add_transition R transition=2 from={"state":"C","outcome":1} to={"state":"B"}',
  ]);
  const aborted = lines(connect(machine, outcome("R/C/D", -1), income("R/B")));
  expect(aborted).toHaveLength(2);
});

test("a transition leads in through starts only", () => {
  expect(lines(connect(machine, outcome("R/B", 0), income("R/C/E")))).toEqual([
    'add_transition R transition=2 from={"state":"B","outcome":0} to={"state":"C"}',
  ]);
  expect(reason(connect(machine, outcome("R/B", 0), income("R/C/D")))).toContain("its start");
});

test("values flow from outputs to inputs of the same type", () => {
  expect(lines(connect(machine, output("R/A", 0), input("R/B", 0)))).toEqual([
    'add_data_flow R data_flow=0 from={"state":"A","port":0} to={"state":"B","port":0}',
  ]);
  expect(lines(connect(machine, input("R/B", 0), output("R/A", 0)))).toHaveLength(1);
  expect(reason(connect(machine, output("R/A", 0), input("R/B", 1)))).toBe(
    "pose is of the type list and does not fit force of the type float: change one of the types, or use object.",
  );
  expect(reason(connect(machine, input("R/B", 0), input("R/B", 1)))).toContain("No value can flow");
  expect(reason(connect(machine, scoped("R", 0), scoped("R", 0)))).toContain("another port");
  expect(reason(connect(machine, output("R/A", 0), income("R/B")))).toContain(
    "cannot be connected",
  );
});

test("a value goes down and up through ports that are made between", () => {
  expect(lines(connect(machine, output("R/A", 0), input("R/C/D", 0)))).toEqual([
    "add_port R/C list=input port=1 name=pose data_type=list default=null",
    'add_data_flow R data_flow=0 from={"state":"A","port":0} to={"state":"C","port":1}',
    'add_data_flow R/C data_flow=0 from={"state":"C","port":1} to={"state":"D","port":0}',
  ]);
  expect(lines(connect(machine, output("R/C/D", 1), input("R/B", 0)))).toEqual([
    "add_port R/C list=output port=1 name=result data_type=list default=null",
    'add_data_flow R/C data_flow=0 from={"state":"D","port":1} to={"state":"C","port":1}',
    'add_data_flow R data_flow=0 from={"state":"C","port":1} to={"state":"B","port":0}',
  ]);
});

test("a port is made where a value is dropped on a state, but not at a library", () => {
  expect(lines(connectToState(machine, output("R/A", 0), "R/C"))[0]).toContain("list=input");
  expect(lines(connectToState(machine, output("R/A", 0), "R"))[0]).toContain(
    "add_port R list=output",
  );
  expect(lines(connectToState(machine, input("R/B", 0), "R/A"))[0]).toContain("list=output");
  expect(reason(connectToState(machine, output("R/A", 0), "R/L"))).toContain("library");
});

test("an end is put elsewhere, also on another level", () => {
  const second: ElementRef = { kind: "transition", path: "R", id: 1 };
  expect(lines(reconnect(machine, second, "to", income("R/C")))).toEqual([
    'set_transition_target R transition=1 to={"state":"C"}',
  ]);
  expect(lines(reconnect(machine, second, "from", outcome("R/A", 1)))).toEqual([
    'set_transition_origin R transition=1 from={"state":"A","outcome":1}',
  ]);
  expect(lines(reconnect(machine, second, "from", outcome("R/C/D", 0)))[0]).toBe(
    "remove_transition R transition=1",
  );
  expect(lines(reconnect(machine, second, "from", income("R")))).toEqual([
    "remove_transition R transition=1",
    'set_start R to={"state":"B"}',
  ]);
});

test("a state is put into a transition", () => {
  const second: ElementRef = { kind: "transition", path: "R", id: 1 };
  expect(lines(insertState(machine, second, "R/C", { x: 0, y: 0 }))).toEqual([
    'set_transition_target R transition=1 to={"state":"C"}',
    'add_transition R transition=2 from={"state":"C","outcome":0} to={"state":"B"}',
  ]);
  const fresh = editsOf(insertState(machine, second, { kind: "execution" }, { x: 150, y: 50 }));
  expect(fresh.map(({ edit }) => edit)).toEqual([
    "add_state",
    "set_transition_target",
    "add_transition",
  ]);
  expect(reason(insertState(machine, second, "R/B", { x: 0, y: 0 }))).toContain("already");
});

test("a library is put into a transition by the first outcome that is no failure", () => {
  const library = { path: "arm", name: "grasp" };
  const root = (outcomes: string) =>
    drawn(`G "Grasp" hierarchy 0 0 200 100 ${outcomes}`).state("G");
  const [grasp, endless] = [root("outcome held outcome lost"), root("")];
  if (!grasp || !endless) throw new Error("the libraries are not drawn");
  const at = { x: 150, y: 50 };
  const second: ElementRef = { kind: "transition", path: "R", id: 1 };
  const plan = insertState(machine, second, { library, root: grasp }, at);
  expect(lines(plan).at(-1)).toMatch(/^add_transition .*"outcome":0} to={"state":"B"}$/);
  expect(reason(insertState(machine, second, { library, root: endless }, at))).toContain("outcome");
});

test("the next state, and the way out, by a key", () => {
  expect(lines(connectToSibling(machine, "R/B"))).toHaveLength(1);
  expect(lines(connectFromSibling(machine, "R/B"))[0]).toContain('to={"state":"B"}');
  expect(lines(connectToParent(machine, "R/B"))[0]).toContain('to={"outcome":0}');
});

test("a transition to the container's first outcome is taken away by asking for it again", () => {
  const led = drawn(`
    R hierarchy 0 0 400 300 outcome done outcome other
      A execution 20 20 80 60 outcome ok
      R > A
      A.ok > R.done
  `);
  expect(lines(connectToParent(led, "R/A"))).toEqual(["remove_transition R transition=1"]);
});

/** A chain of containers, each inside the other, with a state at its end that gives or takes a value. */
function nested(depth: number, end: string, name: string): string {
  const ids = Array.from({ length: depth }, (_, level) => `${name}${level}`);
  const states = ids.map((id, level) => `${"  ".repeat(level + 1)}${id} hierarchy outcome ok`);
  return [...states, `${"  ".repeat(depth + 1)}${name}END execution outcome ok ${end}`].join("\n");
}

test("a value over any number of levels comes by an unbroken chain", () => {
  fc.assert(
    fc.property(fc.nat(5), fc.nat(5), (up, down) => {
      const deep = drawn(
        [
          "R hierarchy outcome ok",
          nested(up, "output v:int", "S"),
          nested(down, "input v:int", "T"),
        ].join("\n"),
      );
      const path = (name: string, depth: number) =>
        ["R", ...Array.from({ length: depth }, (_, level) => `${name}${level}`), `${name}END`].join(
          "/",
        );
      const edits = editsOf(connect(deep, output(path("S", up), 0), input(path("T", down), 0)));
      const flows = edits.flatMap((edit) => (edit.edit === "add_data_flow" ? [edit] : []));
      expect(edits.filter(({ edit }) => edit === "add_port")).toHaveLength(up + down);
      expect(flows).toHaveLength(up + down + 1);
      flows.slice(1).forEach((flow, index) => {
        expect(flow.from).toEqual(flows[index]?.to);
      });
    }),
  );
});
