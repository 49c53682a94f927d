import { expect, test } from "vitest";
import {
  chain,
  connectionInWords,
  connectionsIn,
  connectionsOf,
  type DataPort,
  endInWords,
  endsIn,
  nameOf,
} from "./ends.ts";
import { machineOf } from "./plain_machine.ts";
import { sketch } from "./testing/sketch.ts";

const MACHINE = machineOf(
  sketch(`
    R "Root" hierarchy outcome done input speed:int output way:list scoped found:list
      A "Scan" execution outcome ok output pose:list input v:int
      B "Search" hierarchy outcome ok input pose:list output way:list
        C "Plan" execution outcome ok input pose:list output way:list
        B > C
        C.ok > B.ok
        B.pose >> C.pose
        C.way >> B.way
      R > A
      A.ok > B
      B.ok > R.done
      R.speed >> A.v
      A.pose >> R.found
      R.found >> B.pose
      B.way >> R.way
  `),
);

const words = (path: string, kind: "transition" | "data_flow") =>
  connectionsOf(MACHINE, path, kind).map(({ element }) => connectionInWords(MACHINE, element));

test("connections are told in words", () => {
  expect(words("R/A", "transition")).toEqual(["start → Scan", "Scan.ok → Search"]);
  expect(words("R/B", "transition")).toEqual([
    "Scan.ok → Search",
    "Search.ok → Root.done",
    "start → Plan",
    "Plan.ok → Search.ok",
  ]);
  expect(words("R", "data_flow")).toEqual([
    "Root.speed → Scan.v",
    "Scan.pose → Root.found",
    "Root.found → Search.pose",
    "Search.way → Root.way",
  ]);
  expect(nameOf(MACHINE, { kind: "transition", path: "R", id: 9 })).toBe("transition 9");
});

test("a container tells where its connections can begin and end", () => {
  const ends = (kind: "transition" | "data_flow", end: "from" | "to") =>
    endsIn(MACHINE, "R", kind, end).map((each) => endInWords(MACHINE, "R", each));
  expect(ends("transition", "from")).toEqual([
    "start",
    "Scan.preempted",
    "Scan.aborted",
    "Scan.ok",
    "Search.preempted",
    "Search.aborted",
    "Search.ok",
  ]);
  expect(ends("transition", "to")).toEqual([
    "Scan",
    "Search",
    "Root.preempted",
    "Root.aborted",
    "Root.done",
  ]);
  expect(ends("data_flow", "from")).toEqual([
    "Root.speed",
    "Root.found",
    "Scan.pose",
    "Search.way",
  ]);
  expect(ends("data_flow", "to")).toEqual(["Root.way", "Root.found", "Scan.v", "Search.pose"]);
  expect(connectionsIn(MACHINE, "R/A", "transition")).toEqual([]);
});

function reached(port: DataPort, direction: "forwards" | "backwards"): readonly string[] {
  return chain(MACHINE, port, direction).map(
    ({ port: { path, kind, id }, steps }) =>
      `${steps} ${MACHINE.state(path)?.name}.${nameOf(MACHINE, { kind, path, id })}`,
  );
}

test("values are followed end to end", () => {
  expect(reached({ kind: "output", path: "R/A", id: 0 }, "forwards")).toEqual([
    "1 Root.found",
    "2 Search.pose",
    "3 Plan.pose",
  ]);
  expect(reached({ kind: "output", path: "R", id: 1 }, "backwards")).toEqual([
    "1 Search.way",
    "2 Plan.way",
  ]);
});

test("values are followed into libraries and out of them", () => {
  const document = sketch(`
    R hierarchy input speed:int output way:list
      L library=generic/move input speed:int output way:list
      R.speed >> L.speed
      L.way >> R.way
  `);
  const content = sketch("M hierarchy input speed:int output way:list");
  const [root] = content.states;
  const plain = machineOf(document);
  const machine = {
    ...plain,
    state: (path: string) => (path === "R/L/M" ? root : plain.state(path)),
    children: (path: string) => (path === "R/L" ? ["R/L/M"] : plain.children(path)),
  };
  const paths = (port: DataPort, direction: "forwards" | "backwards") =>
    chain(machine, port, direction).map(({ port: { path }, steps }) => `${steps} ${path}`);
  expect(paths({ kind: "input", path: "R", id: 0 }, "forwards")).toEqual(["1 R/L", "1 R/L/M"]);
  expect(paths({ kind: "output", path: "R/L/M", id: 1 }, "forwards")).toEqual(["0 R/L", "1 R"]);
  expect(paths({ kind: "input", path: "R/L/M", id: 0 }, "backwards")).toEqual(["0 R/L", "1 R"]);
  expect(paths({ kind: "output", path: "R", id: 1 }, "backwards")).toEqual(["1 R/L", "1 R/L/M"]);
});
