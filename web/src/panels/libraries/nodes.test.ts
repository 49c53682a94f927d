import { expect, test } from "vitest";
import { foldersIn, type LibraryTreeNode, matching, nodesOf } from "./nodes.ts";

const nodes = nodesOf([
  {
    name: "arm",
    folder: "/libraries/arm",
    children: [
      {
        name: "skills",
        kind: "folder",
        children: [
          { name: "grasp_mug", kind: "library" },
          { name: "place", kind: "library" },
        ],
      },
      { name: "home", kind: "library" },
    ],
  },
]);

function text(all: readonly LibraryTreeNode[]): readonly string[] {
  return all.flatMap(({ key, library, children }) => [
    `${key}${library ? ` ${library.path}|${library.name}` : ""}`,
    ...text(children ?? []),
  ]);
}

test("libraries are named by their root, folders and name", () => {
  expect(text(nodes)).toEqual([
    "arm",
    "arm/skills",
    "arm/skills/grasp_mug arm/skills|grasp_mug",
    "arm/skills/place arm/skills|place",
    "arm/home arm|home",
  ]);
  expect([...foldersIn(nodes)]).toEqual(["arm", "arm/skills"]);
});

test("a filter leaves what fits, and the folders around it", () => {
  expect(text(matching(nodes, "mug"))).toEqual([
    "arm",
    "arm/skills",
    "arm/skills/grasp_mug arm/skills|grasp_mug",
  ]);
  expect(text(matching(nodes, "skills"))).toHaveLength(4);
  expect(matching(nodes, "nothing")).toEqual([]);
  expect(matching(nodes, " ")).toBe(nodes);
});
