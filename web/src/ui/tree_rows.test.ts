import { expect, test } from "vitest";
import { type TreeSource, treeFind, treeKey, treeRows } from "./tree_rows.ts";

interface Node {
  readonly name: string;
  readonly inside?: readonly Node[];
}

const ROOTS: readonly Node[] = [
  { name: "ape", inside: [{ name: "bear" }, { name: "cat", inside: [{ name: "dog" }] }] },
  { name: "emu" },
];

function source(...expanded: string[]): TreeSource<Node> {
  const id = ({ name }: Node) => name;
  return {
    roots: ROOTS,
    id,
    childrenOf: ({ inside }) => inside ?? null,
    expanded: new Set(expanded),
  };
}

const shown = (...expanded: string[]) =>
  treeRows(source(...expanded)).map(({ id, depth }) => " ".repeat(depth) + id);

test("what is open shows what is inside, and nothing deeper than is open", () => {
  expect(shown()).toEqual(["ape", "emu"]);
  expect(shown("ape")).toEqual(["ape", " bear", " cat", "emu"]);
  expect(shown("cat")).toEqual(["ape", "emu"]);
  expect(shown("ape", "cat")).toEqual(["ape", " bear", " cat", "  dog", "emu"]);
});

test("arrows walk, open and fold as in any tree", () => {
  const rows = treeRows(source("ape"));
  expect(treeKey(rows, 0, "ArrowDown", 5)).toEqual({ to: 1 });
  expect(treeKey(rows, 3, "ArrowDown", 5)).toEqual({ to: 3 });
  expect(treeKey(rows, 2, "ArrowRight", 5)).toEqual({ expand: 2, open: true });
  expect(treeKey(rows, 0, "ArrowRight", 5)).toEqual({ to: 1 });
  expect(treeKey(rows, 0, "ArrowLeft", 5)).toEqual({ expand: 0, open: false });
  expect(treeKey(rows, 1, "ArrowLeft", 5)).toEqual({ to: 0 });
  expect(treeKey(rows, 3, "ArrowLeft", 5)).toBeNull();
  expect(treeKey(rows, 0, "End", 5)).toEqual({ to: 3 });
});

test("typing finds the next row that begins so, around the end", () => {
  const rows = treeRows(source("ape"));
  const text = ({ name }: Node) => name;
  expect(treeFind(rows, 0, "e", text)).toBe(3);
  expect(treeFind(rows, 3, "a", text)).toBe(0);
  expect(treeFind(rows, 0, "ca", text)).toBe(2);
  expect(treeFind(rows, 0, "x", text)).toBe(-1);
});
