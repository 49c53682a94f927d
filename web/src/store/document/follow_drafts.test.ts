import { expect, test } from "vitest";
import type { Edit } from "../../model/generated/protocol.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { memoryStore } from "../local_store.ts";
import { type FieldDraft, openDrafts } from "./drafts.ts";
import { followDrafts } from "./follow_drafts.ts";
import { OptimisticDocument, type TouchedPaths } from "./optimistic_document.ts";
import { predictedWrites } from "./predict/predict.ts";

const DRAFT: FieldDraft = { machine: "m", path: "R/A", field: "script", text: "new", base: "old" };

/** A machine under edit, and the draft of one of its states. */
function followed(draft: FieldDraft) {
  const document = sketch(`
    R hierarchy 0 0 400 300 outcome ok
      A execution 20 20 80 60 outcome ok
      B execution 200 20 80 60 outcome ok
      C hierarchy 20 120 200 150 outcome ok
  `);
  const states = document.states.map((state) =>
    state.kind === "execution" ? { ...state, script: "old" } : state,
  );
  const machine = new OptimisticDocument({ ...document, states }, () => undefined);
  const listeners = new Set<(touched: TouchedPaths) => void>();
  const kept = openDrafts(memoryStore());
  kept.keep(draft);
  const onChange = (listener: (touched: TouchedPaths) => void) => {
    listeners.add(listener);
    return () => void listeners.delete(listener);
  };
  followDrafts({ id: "m", machine, onChange }, kept);
  return (...edits: readonly Edit[]) => {
    const touched = machine.transact(() => {
      for (const edit of edits) machine.applyOptimistic(predictedWrites(machine, edit) ?? []);
    });
    for (const listener of listeners) listener(touched);
    return [...kept.all.peek().values()].map(({ path }) => path);
  };
}

const setId = (path: string, id: string): Edit => ({ edit: "set_id", path, id });
const MOVED: Edit = { edit: "move_states", path: "R", states: ["A"], to: "R/C", ids: ["A"] };

test("a draft follows its state to another id, and back", () => {
  const edit = followed(DRAFT);
  expect(edit(setId("R/A", "X"))).toEqual(["R/X"]);
  expect(edit(setId("R/X", "A"))).toEqual(["R/A"]);
  expect(edit(MOVED)).toEqual(["R/C/A"]);
  expect(edit(setId("R/C", "D"))).toEqual(["R/D/A"]);
});

test("a draft of a state that is removed waits for it, and takes no other one", () => {
  const edit = followed({ ...DRAFT, field: "description", base: "" });
  const gone: Edit = { edit: "remove_state", path: "R", state: "A" };
  expect(edit(gone)).toEqual(["R/A"]);
  const state = { path: "N", name: "N", kind: "execution" as const, outcomes: [] };
  expect(edit({ edit: "add_state", path: "R", states: [state] })).toEqual(["R/A"]);
  expect(edit({ edit: "add_state", path: "R/C", states: [{ ...state, path: "A" }] })).toEqual([
    "R/C/A",
  ]);
});
