import { expect, test } from "vitest";
import { type DraftStorage, type FieldDraft, openDrafts } from "./drafts.ts";

function memory(): DraftStorage & { readonly entries: Map<string, string> } {
  const entries = new Map<string, string>();
  return {
    entries,
    get length() {
      return entries.size;
    },
    key: (index) => [...entries.keys()][index] ?? null,
    getItem: (key) => entries.get(key) ?? null,
    setItem: (key, value) => void entries.set(key, value),
    removeItem: (key) => void entries.delete(key),
  };
}

const DRAFT: FieldDraft = { machine: "m", path: "R/A", field: "script", text: "new", base: "old" };

test("a draft outlives the page until it is dropped", () => {
  const storage = memory();
  openDrafts(storage).keep(DRAFT);
  const again = openDrafts(storage);
  expect(again.get(DRAFT)).toEqual(DRAFT);
  expect(again.get({ ...DRAFT, field: "description" })).toBeUndefined();
  again.drop(DRAFT);
  expect(openDrafts(storage).all.value.size).toBe(0);
});

test("pages side by side keep each other's drafts", () => {
  const storage = memory();
  const [one, other] = [openDrafts(storage), openDrafts(storage)];
  one.keep(DRAFT);
  other.keep({ ...DRAFT, path: "R/B" });
  expect(openDrafts(storage).all.value.size).toBe(2);
});

test("what is no draft, and a storage that is full, do no harm", () => {
  const storage = memory();
  storage.setItem("rafcon.draft:x", "{");
  storage.setItem("rafcon.draft:y", '{"machine": 1}');
  storage.setItem("rafcon.settings", "{}");
  const full: DraftStorage = {
    ...storage,
    length: storage.length,
    setItem: () => {
      throw new Error("full");
    },
  };
  const drafts = openDrafts(full);
  expect(drafts.all.value.size).toBe(0);
  drafts.keep(DRAFT);
  expect(drafts.get(DRAFT)?.text).toBe("new");
});

test("drafts follow a state to its new path", () => {
  const drafts = openDrafts(null);
  drafts.keep(DRAFT);
  drafts.keep({ ...DRAFT, path: "R/AB" });
  drafts.move("m", "R/A", "R/NEW");
  expect([...drafts.all.value.values()].map(({ path }) => path)).toEqual(["R/AB", "R/NEW"]);
});
