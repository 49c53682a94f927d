// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { elementOf } from "../../model/element.ts";
import { driver } from "../testing/driver.ts";
import { ReaderTree, type TreeLine, treeLines } from "./reader.ts";

function lines(canvas: ReturnType<typeof driver>, ...keys: readonly string[]): readonly TreeLine[] {
  const selection = keys.flatMap((key) => elementOf(key) ?? []);
  return treeLines(
    canvas.session.machine,
    canvas.controller.layout(),
    canvas.controller.workingContainer.value,
    selection,
    () => ({}),
  );
}

function short(all: readonly TreeLine[]): readonly string[] {
  return all.map(({ level, number, count, selected, text }) =>
    [level, `${number}/${count}`, selected ? "*" : "", text.split(",")[0]].join(" "),
  );
}

test("the tree has the level that one works in, and what is selected", () => {
  expect(short(lines(driver(), "state:R/B"))).toEqual([
    "1 1/1  Root",
    "2 1/3  Scan",
    "2 2/3 * Grasp",
    "2 3/3  Box",
  ]);
  expect(short(lines(driver(), "state:R/C/D"))).toEqual(["1 1/1  Box", "2 1/1 * Inner"]);
});

test("a selected port stands below its state, a connection in its container", () => {
  expect(short(lines(driver(), "outcome:R/A:1"))).toContain("3 1/1 * outcome lost of Scan");
  expect(short(lines(driver(), "transition:R:1"))[1]).toBe("2 1/1 * transition Scan.ok → Grasp");
});

test("a large level is told in part", () => {
  const states = Array.from({ length: 500 }, (_, row) => `    S${row} execution ${row * 10} 0 9 9`);
  const canvas = driver(`\n  R hierarchy 0 0 5000 100\n${states.join("\n")}`);
  const all = lines(canvas, "state:R/S300");
  expect(all.length).toBeLessThan(90);
  expect(all.find(({ selected }) => selected)).toMatchObject({ count: 500 });
});

test("the element with the focus says which line stands for it", () => {
  const owner = document.createElement("div");
  const reader = new ReaderTree(owner, "test");
  reader.show(lines(driver(), "state:R/B"));
  const active = owner.getAttribute("aria-activedescendant");
  const item = owner.querySelector(`#${active}`);
  expect(item?.textContent).toContain("Grasp");
  expect(item?.getAttribute("aria-selected")).toBe("true");
  expect(reader.elementOf(item)).toEqual({ kind: "state", path: "R/B" });
  reader.show(lines(driver()));
  expect(owner.hasAttribute("aria-activedescendant")).toBe(false);
});
