import { expect, test } from "vitest";
import { projectNode } from "../project_tree.tsx";
import { chosenFolder } from "./folder_chooser.tsx";

const PROJECT = projectNode(
  { id: "p", name: "Missions", folder: "/m" },
  {
    name: "",
    path: "",
    kind: "folder",
    children: [
      { name: "mars", path: "mars", kind: "folder", children: [] },
      { name: "moon", path: "moon", kind: "machine" },
    ],
  },
);
const [MARS = null, MOON = null] = PROJECT.children ?? [];

test("a new folder lies in the folder that was chosen, or in the first project", () => {
  expect(chosenFolder([PROJECT], MARS, "drill").file).toEqual({ project: "p", path: "mars/drill" });
  expect(chosenFolder([PROJECT], null, " drill ").file).toEqual({ project: "p", path: "drill" });
});

test("no machine is saved inside another, nor over what is there", () => {
  expect(chosenFolder([PROJECT], MOON, "x").refusal).toContain("a machine holds no others");
  expect(chosenFolder([PROJECT], PROJECT, "moon").refusal).toContain("already");
  expect(chosenFolder([PROJECT], PROJECT, "a/b").refusal).toContain("no slashes");
  expect(chosenFolder([], null, "x").refusal).toContain("no project");
});
