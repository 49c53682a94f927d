import { expect, test } from "vitest";
import { type FindStates, type PaletteItem, searched } from "./palette_index.ts";

const UNDO = { id: "edit.undo", title: "Undo", run: () => {} } as const;

const ITEMS: readonly PaletteItem[] = [
  { found: { kind: "command", command: UNDO }, title: "Undo", detail: "Edit" },
  {
    found: { kind: "command", command: UNDO },
    title: "Ungroup",
    detail: "Arrange",
    disabled: true,
  },
  { found: { kind: "library", path: "generic", name: "wait" }, title: "wait", detail: "generic" },
];

const UNLOAD: PaletteItem = {
  found: { kind: "state", path: "R/A" },
  title: "Unload sample",
  detail: "Root",
};
const findStates: FindStates = (text) =>
  /^(un.*|)$/.test(text) ? [{ item: UNLOAD, score: 0.5 }] : [];
const titles = (query: string) => searched(ITEMS, query, findStates).map(({ title }) => title);

test("a few letters find states, commands and libraries together", () => {
  expect(titles("un").sort()).toEqual(["Undo", "Ungroup", "Unload sample"]);
  expect(titles("unlsam")).toEqual(["Unload sample"]);
  expect(titles("generic")).toEqual(["wait"]);
});

test("a sign before the text looks in one kind only", () => {
  expect(titles(">un").sort()).toEqual(["Undo", "Ungroup"]);
  expect(titles("@")).toEqual(["Unload sample"]);
  expect(titles("#wa")).toEqual(["wait"]);
});

test("without a text nothing is offered that cannot be done", () => {
  expect(titles(">")).toEqual(["Undo"]);
});
