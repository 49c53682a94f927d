import { expect, test } from "vitest";
import { chosen } from "./chosen_rows.ts";

const ROWS = ["a", "b", "c", "d"];
const ALONE = { toggle: false, extend: false };
const CTRL = { toggle: true, extend: false };
const SHIFT = { toggle: false, extend: true };

test("rows are chosen alone, with Ctrl one by one, with Shift up to another", () => {
  const one = chosen({ ids: new Set(), anchor: null }, ROWS, "b", ALONE);
  expect([...one.ids]).toEqual(["b"]);
  const two = chosen(one, ROWS, "d", CTRL);
  expect([...two.ids]).toEqual(["b", "d"]);
  expect([...chosen(two, ROWS, "b", CTRL).ids]).toEqual(["d"]);
  const range = chosen(one, ROWS, "d", SHIFT);
  expect([...range.ids]).toEqual(["b", "c", "d"]);
  expect([...chosen(range, ROWS, "a", SHIFT).ids]).toEqual(["a", "b"]);
});

test("Shift without a row to begin at chooses the row", () => {
  const gone = { ids: new Set(["x"]), anchor: "x" };
  expect([...chosen(gone, ROWS, "c", SHIFT).ids]).toEqual(["c"]);
});
