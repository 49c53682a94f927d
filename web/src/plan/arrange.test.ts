import Elk from "elkjs/lib/elk.bundled.js";
import { expect, test } from "vitest";
import type { Document, StateDocument } from "../model/generated/protocol.ts";
import { type Box, intersects } from "../model/geometry.ts";
import { childBox, readLayout, rootSize } from "../model/layout_reader.ts";
import { type Machine, transitionsOf } from "../model/machine.ts";
import { machineOf } from "../model/plain_machine.ts";
import { sketch } from "../model/testing/sketch.ts";
import { arrange, elkGraph } from "./arrange.ts";
import { arranged } from "./arranged.ts";
import { isStoredRightAngled, storedWay } from "./right_angles.ts";
import { editsOf, reason } from "./testing/plans.ts";

const MISSION = `
  R "Root" hierarchy outcome done
    A execution outcome ok
    B hierarchy outcome ok
      D execution outcome ok
      E execution outcome ok
      F barrier outcome ok
        G execution outcome ok
        H execution outcome ok
      B > D
      D.ok > E
      E.ok > F
      F.ok > B.ok
    C execution outcome ok
    ERR "Handle error" execution outcome ok
    R > A
    A.ok > B
    B.ok > C
    B.aborted > ERR
    C.ok > R.done
    ERR.ok > C
`;

const elk = new Elk();

async function laidOut(document: Document, container: string, deep: boolean): Promise<Machine> {
  const machine = machineOf(document);
  const levels = await arrange(machine, container, deep, (graph) => elk.layout(graph));
  const layouts = new Map(
    editsOf(arranged(machine, container, levels)).flatMap((edit) =>
      edit.edit === "set_layout" ? [[edit.path, edit.layout] as const] : [],
    ),
  );
  const states = document.states.map((state): StateDocument => {
    const layout = layouts.get(state.path);
    return layout ? { ...state, layout } : state;
  });
  return machineOf({ ...document, states });
}

function boxesIn(machine: Machine, path: string): ReadonlyMap<string, Box> {
  const state = machine.state(path);
  const size = (state && readLayout(state).size) ?? rootSize({ path, name: "", kind: "hierarchy" });
  return new Map(
    machine.children(path).flatMap((child, index) => {
      const found = machine.state(child);
      return found ? [[child, childBox(found, index, size)] as const] : [];
    }),
  );
}

/** No two states overlap, and all are inside of the state around them. */
function expectTidy(machine: Machine, path: string): void {
  const state = machine.state(path);
  const size = state && readLayout(state).size;
  const boxes = [...boxesIn(machine, path)];
  for (const [child, box] of boxes) {
    expect(box.x, child).toBeGreaterThanOrEqual(0);
    expect(box.y, child).toBeGreaterThanOrEqual(0);
    expect(box.x + box.width, child).toBeLessThanOrEqual((size?.width ?? 0) + 1e-6);
    expect(box.y + box.height, child).toBeLessThanOrEqual((size?.height ?? 0) + 1e-6);
    for (const [other, second] of boxes) {
      if (other !== child) expect(intersects(box, second), `${child} and ${other}`).toBe(false);
    }
    expectTidy(machine, child);
  }
}

test("all levels are tidy: nothing overlaps, everything is inside", async () => {
  expectTidy(await laidOut(sketch(MISSION), "R", true), "R");
});

test("states follow the start, and error handlers lie below them", async () => {
  const boxes = boxesIn(await laidOut(sketch(MISSION), "R", true), "R");
  const at = (id: string) => boxes.get(`R/${id}`) ?? { x: 0, y: 0, width: 0, height: 0 };
  const before = (one: string, other: string) =>
    at(other).x > at(one).x || at(other).y > at(one).y + at(one).height;
  expect([before("A", "B"), before("B", "C"), before("B", "ERR")]).toEqual([true, true, true]);
});

test("a loop back to the start by way of an error is laid out", async () => {
  const recovery = sketch(`
    R "Root" hierarchy 0 0 1000 500 outcome done
      C execution 600 40 120 72 outcome none outcome turn outcome reach
      I execution 40 40 500 292 outcome ok
      A execution 800 200 120 72 outcome ok
      T execution 800 40 120 72 outcome ok
      R > I
      I.aborted > C
      C.none > T
      C.turn > A
      T.ok > I
      A.ok > I
  `);
  expectTidy(await laidOut(recovery, "R", false), "R");
});

/** Eight steps that each repeat, skip one and go on. */
function loops(): string {
  const steps = [1, 2, 3, 4, 5, 6, 7, 8];
  const goal = (step: number) => (step > 8 ? "R.done" : `S${step}`);
  const outcomes = "outcome again outcome skip outcome ok";
  const lines = steps.flatMap((step) => [
    `  S${step}.again > S${step}`,
    `  S${step}.skip > ${goal(step + 2)}`,
    `  S${step}.ok > ${goal(step + 1)}`,
  ]);
  const states = steps.map((step) => `  S${step} execution ${outcomes}`);
  return ["R hierarchy outcome done", ...states, "  R > S1", ...lines].join("\n");
}

test.each([true, false])("stored ways are at right angles, all levels: %s", async (deep) => {
  const machine = await laidOut(sketch(loops()), "R", deep);
  const root = machine.state("R");
  const stored = (root ? transitionsOf(root) : []).filter(
    (line) => storedWay(machine, "R", line).length > 0,
  );
  const slanted = stored.filter((line) => !isStoredRightAngled(machine, "R", line));
  expect(stored.length).toBeGreaterThan(8);
  expect(slanted).toEqual([]);
});

test("one level keeps its size and scales what stands in it", async () => {
  const document = await laidOut(sketch(MISSION), "R", true);
  const again = await laidOut({ ...sketch(MISSION), states: statesOf(document) }, "R/B", false);
  expectTidy(again, "R");
  const size = (machine: Machine) => boxesIn(machine, "R").get("R/B");
  expect(size(again)).toEqual(size(document));
});

function statesOf(machine: Machine): StateDocument[] {
  return [...machine.paths()].flatMap((path) => machine.state(path) ?? []);
}

test("only lines between states shape the picture", () => {
  const graph = elkGraph(machineOf(sketch(MISSION)), "R", new Map());
  expect(graph.edges?.map(({ sources, targets }) => `${sources} ${targets}`)).toEqual([
    "A:outcome0 B:income",
    "B:outcome0 C:income",
    "B:outcome-1 ERR:income",
    "ERR:outcome0 C:income",
  ]);
});

test("an empty container is refused", async () => {
  const machine = machineOf(sketch("R hierarchy outcome done"));
  expect(reason(arranged(machine, "R", new Map()))).toContain("nothing to arrange");
});
