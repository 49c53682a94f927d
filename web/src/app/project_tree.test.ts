import { expect, test } from "vitest";
import { filtered, nodeKey, projectNode } from "./project_tree.tsx";

const PROJECT = projectNode(
  { id: "p", name: "Missions", folder: "/missions" },
  {
    name: "",
    path: "",
    kind: "folder",
    children: [
      {
        name: "mars",
        path: "mars",
        kind: "folder",
        children: [
          { name: "drill", path: "mars/drill", kind: "machine" },
          { name: "drive", path: "mars/drive", kind: "machine" },
        ],
      },
      { name: "empty", path: "empty", kind: "folder" },
    ],
  },
);

function keys(nodes: readonly (typeof PROJECT)[]): string[] {
  return nodes.flatMap((node) => [nodeKey(node), ...keys(node.children ?? [])]);
}

test("a search keeps what it finds and what is around it", () => {
  expect(keys(filtered([PROJECT], "DRI"))).toEqual([
    "p/",
    "p/mars",
    "p/mars/drill",
    "p/mars/drive",
  ]);
  expect(keys(filtered([PROJECT], "emp"))).toEqual(["p/", "p/empty"]);
  expect(filtered([PROJECT], "moon")).toEqual([]);
});

test("a machine cannot be opened as a folder, an empty folder can", () => {
  const [mars, empty] = PROJECT.children ?? [];
  expect(mars?.children?.map((node) => node.children)).toEqual([null, null]);
  expect(empty?.children).toEqual([]);
});
