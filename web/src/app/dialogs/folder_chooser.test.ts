import { expect, test } from "vitest";
import { projectNode } from "../project_tree.tsx";
import { chosenFolder, libraryOf, placeInWords } from "./folder_chooser.tsx";

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

test("slashes in the name make folders on the way, unless a machine stands in it", () => {
  expect(chosenFolder([PROJECT], PROJECT, "mars/rover/drill").file?.path).toBe("mars/rover/drill");
  expect(chosenFolder([PROJECT], MARS, "rover / drill").file?.path).toBe("mars/rover/drill");
  expect(chosenFolder([PROJECT], PROJECT, "moon/drill").refusal).toContain(
    "cannot contain other machines",
  );
  for (const name of ["/drill", "mars//drill", "mars/", "../drill", ".git", "a\\b"])
    expect(chosenFolder([PROJECT], PROJECT, name).refusal).toContain("Enter a folder name");
});

test("it is said where it will lie, and as which library", () => {
  const [project] = [{ id: "p", name: "Missions", folder: "/m" }];
  const roots = [{ name: "skills", folder: "/m/mars", children: [] }];
  const libraryAt = (path: string) => libraryOf([project], roots, { project: "p", path });
  expect([libraryAt("mars"), libraryAt("mars/rover"), libraryAt("marsh"), libraryAt("")]).toEqual([
    "skills",
    "skills/rover",
    null,
    null,
  ]);
  const at = (name: string) => {
    const { file } = chosenFolder([PROJECT], MARS, name);
    return file && placeInWords([project], roots, file);
  };
  expect(at("drill")).toBe("Location: Missions / mars / drill, as the library skills/drill.");
  expect(placeInWords([project], [], { project: "p", path: "drill" })).toBe(
    "Location: Missions / drill.",
  );
});

test("no machine is saved inside another, nor over what is there", () => {
  expect(chosenFolder([PROJECT], MOON, "x").refusal).toContain("cannot contain other machines");
  expect(chosenFolder([PROJECT], PROJECT, "moon").refusal).toContain("already");
  expect(chosenFolder([], null, "x").refusal).toContain("no project");
});
