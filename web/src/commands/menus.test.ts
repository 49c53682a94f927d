import { expect, test } from "vitest";
import { elementOf } from "../model/element.ts";
import { allCommands } from "./all.ts";
import { barMenu, type CommandMenuEntry, contextMenu, menuTitles } from "./menus.ts";
import { type TestContext, type TestContextOptions, testContext } from "./testing/context.ts";

const MACHINE = `
  R "Root" hierarchy 0 0 400 300 outcome done scoped count:int
    A "Scan" execution 20 20 80 60 outcome ok input speed:int
    B "Both" barrier 120 20 80 60 outcome ok
    L "Drive" library 220 20 80 60 outcome ok library=motion/drive
    R > A
    A.ok > R.done
`;

const COMMANDS = allCommands();

function source(context: TestContext) {
  return { commands: COMMANDS, context, keys: (id: string) => COMMANDS.find(id)?.keys ?? [] };
}

/** Titles of a menu: what cannot be done in brackets, what is on with a star, menus inside with theirs. */
function shown(entries: readonly CommandMenuEntry[]): string[] {
  return entries.map((entry) => {
    if (entry === "separator") return "—";
    const title = entry.items ? `${entry.title} ▸` : entry.title;
    return entry.disabled ? `[${title}]` : `${title}${entry.checked ? " *" : ""}`;
  });
}

function menuOf(key: string, options: TestContextOptions = {}): string[] {
  const element = elementOf(key);
  const context = testContext(MACHINE, { ...options, selected: element ? [key] : [] });
  return shown(contextMenu(source(context), element ? [element] : []));
}

test("the bar has the menus that have entries, with keys, in blocks", () => {
  expect(menuTitles(COMMANDS)).toEqual([
    "File",
    "Edit",
    "Insert",
    "Arrange",
    "View",
    "Run",
    "Help",
  ]);
  const edit = barMenu(source(testContext(MACHINE)), "Edit");
  expect(shown(edit).slice(0, 4)).toEqual(["Undo", "Redo", "—", "[Cut]"]);
  expect(edit[0]).toMatchObject({ id: "edit.undo", keys: "Ctrl+Z" });
});

test("a state can be made the start, grouped and changed; the root cannot", () => {
  const state = menuOf("state:R/A");
  expect(state).toContain("Is start state *");
  expect(state).toContain("Group");
  expect(state).toContain("Change kind ▸");
  expect(state).toContain("[Ungroup]");
  const root = menuOf("state:R");
  expect(root).toContain("[Is start state]");
  expect(root).toContain("[Group]");
  expect(root).toContain("[Substitute by library…]");
});

test("a container can be ungrouped, and takes scoped variables; others do not", () => {
  expect(menuOf("state:R/B")).toContain("Ungroup");
  const titles = (key: string) => {
    const context = testContext(MACHINE, { selected: [key] });
    const element = elementOf(key);
    const menu = contextMenu(source(context), element ? [element] : []);
    const add = menu.find((entry) => entry !== "separator" && entry.title === "Add");
    return add && add !== "separator" ? shown(add.items ?? []) : [];
  };
  expect(titles("state:R/B")).toContain("Scoped variable");
  expect(titles("state:R/A")).toContain("[Scoped variable]");
});

test("the menu of a state fits a screen of 720 pixels", () => {
  const [ENTRY, SEPARATOR, BORDERS] = [26, 9, 10];
  for (const key of ["state:R", "state:R/A", "state:R/B", "state:R/L"]) {
    const heights = menuOf(key).map((entry): number => (entry === "—" ? SEPARATOR : ENTRY));
    expect(heights.reduce((sum, height) => sum + height, BORDERS)).toBeLessThan(720);
  }
  expect(menuOf("state:R/A")).toContain("Layout ▸");
});

test("a library is opened, shown and substituted, and its kind stays", () => {
  const menu = menuOf("state:R/L");
  expect(menu).toContain("Open library separately");
  expect(menu).toContain("Substitute by the library's content ▸");
  expect(menu.join()).not.toContain("Change kind");
});

test("ports, connections and the canvas have menus of their own", () => {
  expect(menuOf("input:R/A:0")).toContain("Rename");
  expect(menuOf("transition:R:0")).toEqual([
    "Insert into transition ▸",
    "—",
    "Remove waypoints",
    "—",
    "Delete",
    "—",
    "Zoom to selection",
  ]);
  expect(menuOf("")).toContain("Add ▸");
});

test("who may only look is offered nothing that edits", () => {
  const menu = menuOf("state:R/A", { rights: ["observe"] });
  expect(menu).toContain("[Delete]");
  expect(menu).toContain("[Add ▸]");
  expect(menu).toContain("Copy");
});
