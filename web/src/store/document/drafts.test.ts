import { expect, test } from "vitest";
import { memoryStore } from "../local_store.ts";
import { type FieldDraft, openDrafts } from "./drafts.ts";

const DRAFT: FieldDraft = { machine: "m", path: "R/A", field: "script", text: "new", base: "old" };

test("a draft outlives the page until it is dropped", () => {
  const storage = memoryStore();
  openDrafts(storage).keep(DRAFT);
  const again = openDrafts(storage);
  expect(again.get(DRAFT)).toEqual(DRAFT);
  expect(again.get({ ...DRAFT, field: "description" })).toBeUndefined();
  again.drop(DRAFT);
  expect(openDrafts(storage).all.value.size).toBe(0);
});

test("pages side by side keep each other's drafts", () => {
  const storage = memoryStore();
  const [one, other] = [openDrafts(storage), openDrafts(storage)];
  one.keep(DRAFT);
  other.keep({ ...DRAFT, path: "R/B" });
  expect(openDrafts(storage).all.value.size).toBe(2);
});

test("what is no draft, and a store without room, do no harm", () => {
  const store = memoryStore();
  store.put("rafcon.draft:x", "{");
  store.put("rafcon.draft:y", { machine: 1 });
  store.put("rafcon.settings", {});
  const drafts = openDrafts({ ...store, put: () => {} });
  expect(drafts.all.value.size).toBe(0);
  drafts.keep(DRAFT);
  expect(drafts.get(DRAFT)?.text).toBe("new");
});

test("drafts follow a state to its new path", () => {
  const drafts = openDrafts(memoryStore());
  drafts.keep(DRAFT);
  drafts.keep({ ...DRAFT, path: "R/AB" });
  drafts.move("m", "R/A", "R/NEW");
  expect([...drafts.all.value.values()].map(({ path }) => path)).toEqual(["R/AB", "R/NEW"]);
});
