import { expect, test } from "vitest";
import { match, queryOf } from "./match.ts";
import { machineOf } from "./plain_machine.ts";
import { search } from "./search.ts";
import { sketch } from "./testing/sketch.ts";

const machine = machineOf(
  sketch(`
    R "Fetch the mug" hierarchy outcome done
      SCAN "Scan the table" execution outcome ok output mug_pose:list
      GRASP "Grasp" library library=arm/skills/grasp_mug input speed:float=0.25
      MOVE "moveToTable" execution outcome ok
  `),
);

function found(text: string): readonly string[] {
  return search(machine, text, { count: 20 }).hits.map(
    ({ element, field, text: where }) => `${element.path} ${field} ${where}`,
  );
}

test("names come before ports, and those before everything else", () => {
  expect(found("mug")).toEqual([
    "R name Fetch the mug",
    "R/SCAN output mug_pose",
    "R/GRASP library arm/skills/grasp_mug",
  ]);
});

test("words stand in any order, and letters of names may stand apart", () => {
  expect(found("table scan")).toEqual(["R/SCAN name Scan the table"]);
  expect(found("ftm")).toEqual(["R name Fetch the mug"]);
  expect(found("nothing like this")).toEqual([]);
});

test("the beginning of a word counts more than its middle", () => {
  const [first] = found("table");
  expect(first).toMatch(/R\/SCAN name|R\/MOVE name/);
  const score = (text: string) => match(queryOf("tab"), text)?.score ?? 0;
  expect(score("moveToTable")).toBeGreaterThan(score("unstable"));
  expect(score("table")).toBeGreaterThan(score("the table"));
});

test("values and types are found at their ports", () => {
  const [hit] = search(machine, "0.25", { count: 5 }).hits;
  expect(hit).toMatchObject({ field: "value", element: { kind: "input", path: "R/GRASP", id: 0 } });
  expect(search(machine, "float", { count: 5, scope: "ports" }).total).toBe(1);
  expect(search(machine, "float", { count: 5, scope: "names" }).total).toBe(0);
});

test("of a script the line is told", () => {
  const [root, ...rest] = sketch("R execution").states;
  const script = "def execute(self, inputs, outputs, gvm):\n    gvm.set_variable('speed', 3)\n";
  const one = machineOf({
    header: { creation_time: "" },
    states: root ? [{ ...root, script }, ...rest] : [],
  });
  const [hit] = search(one, "set_variable", { count: 5 }).hits;
  expect(hit).toMatchObject({ field: "script", line: 2, text: "gvm.set_variable('speed', 3)" });
  expect(hit?.spans).toEqual([{ start: 4, length: 12 }]);
});

test("what is found is counted though not all of it is given", () => {
  const { hits, total } = search(machine, "e", { count: 2 });
  expect(hits).toHaveLength(2);
  expect(total).toBeGreaterThan(2);
});
