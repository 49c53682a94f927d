import { describe, expect, it } from "vitest";
import type { Edit, StateDocument } from "../../../model/generated/protocol.ts";
import { machineOf } from "../../../model/plain_machine.ts";
import { sketch } from "../../../model/testing/sketch.ts";
import { OptimisticDocument } from "../optimistic_document.ts";
import { predictedWrites } from "./predict.ts";

const TEXT = `
  R hierarchy 0 0 400 300 outcome done input speed:int=3 scoped found:list
    A execution 20 20 80 60 outcome ok outcome lost output pose:list
    B barrier 200 20 80 60 outcome ok input pose:list
      C execution outcome ok
      unique_decider_state_id decider outcome success
    R > A
    A.ok > B
    A.lost > R.done
    A.pose >> B.pose
    A.pose >> R.found`;

/** Changes by the edit: removed paths, and changed states. */
function done(
  edit: Edit,
): { gone: string[]; states: Record<string, Partial<StateDocument>> } | null {
  const document = sketch(TEXT);
  const writes = predictedWrites(machineOf(document), edit);
  if (!writes) return null;
  const machine = new OptimisticDocument(document, () => undefined);
  const touched = machine.transact(() => machine.applyOptimistic(writes)) ?? [];
  const gone = [...touched].filter((path) => !machine.state(path));
  const there = [...touched].flatMap((path) => machine.state(path) ?? []);
  return { gone, states: Object.fromEntries(there.map((state) => [state.path, state])) };
}

describe("what an edit will do", () => {
  it("takes the connections of a state away with it", () => {
    const found = done({ edit: "remove_state", path: "R", state: "A" });
    expect(found?.gone).toEqual(["R/A"]);
    expect(found?.states["R"]).not.toHaveProperty("transitions");
    expect(found?.states["R"]).not.toHaveProperty("data_flows");
    expect(found?.states["R"]?.outcomes).toHaveLength(3);
  });

  it("takes everything inside a state away with it", () => {
    const found = done({ edit: "remove_state", path: "R", state: "B" });
    expect(found?.gone.toSorted()).toEqual(["R/B", "R/B/C", "R/B/unique_decider_state_id"]);
  });

  it("takes the connections of an outcome and of a port away with them", () => {
    const outcome = done({ edit: "remove_outcome", path: "R", outcome: 0 });
    expect(outcome?.states["R"]?.transitions?.map(({ id }) => id)).toEqual([0, 1]);
    const port = done({ edit: "remove_port", path: "R/A", list: "output", port: 0 });
    expect(port?.states["R"]).not.toHaveProperty("data_flows");
    const scoped = done({ edit: "remove_port", path: "R", list: "scoped_variable", port: 1 });
    expect(scoped?.states["R"]?.data_flows?.map(({ id }) => id)).toEqual([0]);
  });

  it("leads what a child of a barrier ends with to the decider", () => {
    const states: StateDocument[] = [
      { path: "D", name: "D", kind: "execution", outcomes: [{ id: 0, name: "ok" }] },
    ];
    const found = done({ edit: "add_state", path: "R/B", states });
    expect(found?.states["R/B"]?.transitions).toEqual([
      { id: 1, from_state: "D", from_outcome: 0, to_state: "unique_decider_state_id" },
    ]);
    expect(found?.states["R/B/D"]?.outcomes?.map(({ id }) => id)).toEqual([-2, -1, 0]);
  });

  it("gives a new barrier a decider", () => {
    const states: StateDocument[] = [{ path: "D", name: "D", kind: "barrier" }];
    const found = done({ edit: "add_state", path: "R", states });
    expect(Object.keys(found?.states ?? {})).toContain("R/D/unique_decider_state_id");
  });

  it("keeps what else a layout says", () => {
    const position: [number, number] = [7, 8];
    const found = done({ edit: "set_position", path: "R/A", element: "state", position });
    const items = (numbers: readonly number[]) => ({
      __jsonqualname__: "__builtin__.tuple",
      items: numbers,
    });
    expect(found?.states["R/A"]?.layout).toEqual({
      gui: { editor_gaphas: { rel_pos: items([7, 8]), size: [80, 60] } },
    });
  });

  it("moves the start, or takes it away", () => {
    const moved = done({ edit: "set_start", path: "R", to: { state: "B" } });
    expect(moved?.states["R"]?.transitions?.[0]).toEqual({ id: 0, to_state: "B" });
    const gone = done({ edit: "set_start", path: "R", to: null });
    expect(gone?.states["R"]?.transitions?.map(({ id }) => id)).toEqual([1, 2]);
  });

  it("is said of all edits of a batch, or of none", () => {
    const rename: Edit = { edit: "set_name", path: "R/A", name: "Look" };
    const both = done({ edit: "batch", edits: [rename, { ...rename, path: "R/B" }] });
    expect(Object.keys(both?.states ?? {}).toSorted()).toEqual(["R/A", "R/B"]);
    const faulty: Edit = { edit: "remove_state", path: "R", state: "NONE" };
    expect(done({ edit: "batch", edits: [rename, faulty] })).toBeNull();
  });

  it("is not said of what only the server knows", () => {
    expect(done({ edit: "ungroup", path: "R", state: "B", fresh: [] })).toBeNull();
    const decider = "unique_decider_state_id";
    expect(done({ edit: "remove_state", path: "R/B", state: decider })).toBeNull();
    expect(done({ edit: "set_script", path: "R", script: "x" })).toBeNull();
  });
});
