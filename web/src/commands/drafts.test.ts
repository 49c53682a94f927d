import { expect, test } from "vitest";
import type { Edit } from "../model/generated/protocol.ts";
import { machineOf } from "../model/plain_machine.ts";
import { sketch } from "../model/testing/sketch.ts";
import { type FieldDraft, openDrafts } from "../store/document/drafts.ts";
import type { EditAnswer } from "../store/document/machine_session.ts";
import { memoryStore } from "../store/local_store.ts";
import type { OpenTab } from "../store/page/page.ts";
import { applyDrafts } from "./drafts.ts";

function setUp(answer: EditAnswer = { revision: 1 }) {
  const machine = machineOf(sketch('R hierarchy\n  A "Scan" execution\n  B execution'));
  const [edits, notices]: [Edit[], string[]] = [[], []];
  const session = {
    id: "m",
    machine,
    edit: async (_: string, edit: Edit) => {
      edits.push(edit);
      return answer;
    },
  } as unknown as OpenTab["session"];
  const page = { tell: ({ text }: { text: string }) => void notices.push(text) };
  const drafts = openDrafts(memoryStore());
  const draft: FieldDraft = { machine: "m", path: "R/A", field: "script", text: "new", base: "" };
  return { edits, notices, drafts, draft, apply: () => applyDrafts(page, { session }, drafts) };
}

test("drafts of the machine are applied and gone", async () => {
  const { edits, notices, drafts, draft, apply } = setUp();
  drafts.keep(draft);
  drafts.keep({ ...draft, path: "R", field: "description", text: "**what**" });
  drafts.keep({ ...draft, machine: "another" });
  expect(await apply()).toBe(true);
  expect(edits).toEqual([
    { edit: "set_script", path: "R/A", script: "new" },
    { edit: "set_description", path: "R", description: "**what**" },
  ]);
  expect(notices).toEqual([]);
  expect([...drafts.all.value.values()].map(({ machine }) => machine)).toEqual(["another"]);
});

test("drafts that cannot be applied stay, and it is told why", async () => {
  const { edits, notices, drafts, draft, apply } = setUp();
  drafts.keep({ ...draft, base: "it was like this" });
  drafts.keep({ ...draft, path: "R" });
  expect(await apply()).toBe(false);
  expect(edits).toEqual([]);
  expect(notices).toHaveLength(2);
  expect(notices[0]).toContain("Someone else changed the script of Scan");
  expect(drafts.all.value.size).toBe(2);
});

test("a draft of a state that is gone waits and hinders no one", async () => {
  const { edits, notices, drafts, draft, apply } = setUp();
  drafts.keep({ ...draft, path: "R/GONE" });
  expect(await apply()).toBe(true);
  expect([edits, notices]).toEqual([[], []]);
  expect(drafts.all.value.size).toBe(1);
});

test("a refusal of the server keeps the draft", async () => {
  const { notices, drafts, draft, apply } = setUp({ refused: "not now" });
  drafts.keep(draft);
  expect(await apply()).toBe(false);
  expect(notices).toEqual(["not now"]);
  expect(drafts.get(draft)?.text).toBe("new");
});
