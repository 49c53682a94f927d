// @vitest-environment happy-dom

import { signal } from "@preact/signals-core";
import { beforeEach, expect, test } from "vitest";
import type { OpenTab } from "../page/page.ts";
import { setStateWatched } from "./watched_states.ts";
import { addWatched, changeWatched, removeWatched, watchedOf } from "./watched_values.ts";

beforeEach(() => localStorage.clear());

const X = { kind: "input", path: "R/A", name: "x" } as const;

/** A tab with a machine in a project. */
function tab(path: string): OpenTab {
  const file = { project: "arm", path };
  return {
    session: { id: path, status: signal({ summary: { file } }) },
    run: signal(null),
  } as unknown as OpenTab;
}

test("kept by machine, and watched once", () => {
  addWatched(tab("pick"), X);
  addWatched(tab("pick"), X);
  addWatched(tab("place"), { ...X, name: "y" });
  expect(watchedOf(tab("pick")).value).toEqual([{ id: 1, target: X, expression: "value" }]);
  const kept = JSON.parse(localStorage.getItem("rafcon.watched") ?? "{}");
  expect(Object.keys(kept)).toEqual(["arm/pick", "arm/place"]);
});

test("what another tab of the browser watches is watched here", () => {
  const here = tab("weld");
  addWatched(here, X);
  const theirs = [{ id: 1, target: X, expression: "abs(value)" }];
  localStorage.setItem("rafcon.watched", JSON.stringify({ "arm/weld": theirs }));
  window.dispatchEvent(new StorageEvent("storage", { key: "rafcon.watched" }));
  expect(watchedOf(here).value).toEqual(theirs);
  window.dispatchEvent(new StorageEvent("storage", { key: "rafcon.another" }));
  expect(watchedOf(here).value).toEqual(theirs);
});

test("another expression of the same value, and no more", () => {
  const here = tab("sort");
  addWatched(here, X);
  changeWatched(here, 1, "len(value)");
  addWatched(here, X);
  expect(watchedOf(here).value.map(({ expression }) => expression)).toEqual([
    "len(value)",
    "value",
  ]);
  removeWatched(here, 1);
  expect(watchedOf(here).value.map(({ id }) => id)).toEqual([2]);
});

test("of more than fifty machines the watches of the one watched first go", () => {
  const kept = (key: string) => Object.keys(JSON.parse(localStorage.getItem(key) ?? "{}"));
  for (let at = 1; at <= 50; at += 1) {
    addWatched(tab(`many ${at}`), X);
    setStateWatched(tab(`many ${at}`), "R/A", true);
  }
  for (const key of ["rafcon.watched", "rafcon.watched_states"]) {
    expect([kept(key).length, kept(key)[0]]).toEqual([50, "arm/many 1"]);
  }
  addWatched(tab("many 51"), X);
  setStateWatched(tab("many 51"), "R/A", true);
  for (const key of ["rafcon.watched", "rafcon.watched_states"]) {
    expect([kept(key).length, kept(key)[0], kept(key).at(-1)]).toEqual([
      50,
      "arm/many 2",
      "arm/many 51",
    ]);
  }
});
