// @vitest-environment happy-dom

import { afterEach, beforeEach, expect, test } from "vitest";
import { byRole, click, draw, mount, unmount } from "../../../ui/testing/mounted.tsx";
import { placesOf } from "./long_text.tsx";
import { pixelsOf } from "./numbers_view.tsx";
import { ValueView } from "./value_view.tsx";

beforeEach(() => localStorage.clear());
afterEach(unmount);

const POSE = {
  frame: "map",
  position: [0.1, 0.2, 0.30000000000000004],
  deep: { er: { still: 1 } },
};

function fold(place: HTMLElement, name: string): HTMLElement | null {
  return place.querySelector<HTMLElement>(`button[aria-label^="${name}:"]`);
}

test("a dict folds open level by level, and what is folded is not made", () => {
  const place = mount(<ValueView name="pose" value={POSE} />);
  expect(place.querySelector(".value-inside")).toBeNull();
  click(fold(place, "pose"));
  expect(place.textContent).toContain('"map"');
  expect(fold(place, "er")).toBeNull();
  click(fold(place, "deep"));
  click(fold(place, "er"));
  expect(place.querySelector(".value-inside .value-inside .value-inside")?.textContent).toBe(
    "still1number",
  );
});

test("another value leaves open what is open", () => {
  const place = mount(<ValueView name="pose" value={POSE} />);
  click(fold(place, "pose"));
  click(fold(place, "position"));
  draw(<ValueView name="pose" value={{ ...POSE, position: [7, 8, 9] }} />);
  const rows = [...place.querySelectorAll(".value-inside .value-inside .value-short")];
  expect(rows.map((row) => row.textContent)).toEqual(["7", "8", "9"]);
});

test("a value comes back as it was left", () => {
  click(fold(mount(<ValueView keep="A/pose" name="pose" value={POSE} />), "pose"));
  const again = mount(<ValueView keep="A/pose" name="pose" value={POSE} />);
  expect(fold(again, "pose")?.getAttribute("aria-expanded")).toBe("true");
});

test("records are a table, and a list when asked; the choice stays", () => {
  const value = [
    { name: "cup", x: 1 },
    { name: "box", x: 2 },
  ];
  const place = mount(<ValueView name="found" value={value} openAtFirst />);
  const heads = [...place.querySelectorAll("thead th")].map((head) => head.textContent);
  expect(heads).toEqual([" ", "name", "x"]);
  click([...place.querySelectorAll(".value-form")].find((b) => b.textContent === "List") ?? null);
  expect(place.querySelector("table")).toBeNull();
  unmount();
  const other = mount(<ValueView name="other" value={value} openAtFirst />);
  expect(other.querySelector("table")).toBeNull();
});

test("an array is told with what was taken of it", () => {
  const array = {
    __repr__: "array(…)",
    __class__: "ndarray",
    __dtype__: "float64",
    __shape__: [4, 4],
    __items__: [1, 2, 3, { __repr__: "nan", __class__: "float" }],
    __sampled__: [2, 2],
    __steps__: [2, 2],
  };
  const place = mount(<ValueView name="grid" value={array} openAtFirst />);
  expect(place.textContent).toContain("float64 ⟨4×4⟩");
  expect(place.textContent).toContain("ndarray of float64, 4 × 4; showing one in 2 × 2");
  const heads = [...place.querySelectorAll("tbody th")].map((head) => head.textContent);
  expect(heads).toEqual(["0", "2"]);
  expect(place.querySelector("tbody tr:last-child")?.textContent).toBe("23nan");
});

test("numbers as a plot", () => {
  const array = {
    __repr__: "…",
    __class__: "ndarray",
    __dtype__: "float64",
    __shape__: [3],
    __items__: [1, 5, 3],
  };
  const place = mount(<ValueView name="ranges" value={array} openAtFirst />);
  expect(byRole(place, "img")[0]?.getAttribute("aria-label")).toBe("ranges: 3 numbers from 1 to 5");
});

test("long lists are made piece by piece, and say what was not kept", () => {
  const first = Array.from({ length: 60 }, (_, index) => `item ${index}`);
  const value = { __repr__: "list of 1000", __class__: "list", __len__: 1000, __first__: first };
  const place = mount(<ValueView name="all" value={value} openAtFirst />);
  expect(place.textContent).not.toContain("item 55");
  const more = [...place.querySelectorAll("button")].find((b) => b.textContent?.startsWith("Show"));
  expect(more?.textContent).toBe("Show 10 more of 60");
  click(more ?? null);
  expect(place.textContent).toContain("item 55");
  expect(place.textContent).toContain("940 more were not kept");
});

test("a long text shows its first lines, and all when asked", () => {
  const text = Array.from({ length: 30 }, (_, index) => `line ${index}`).join("\n");
  const place = mount(<ValueView name="report" value={text} openAtFirst />);
  const pre = () => place.querySelector("pre")?.textContent ?? "";
  expect(pre()).not.toContain("line 29");
  const all = [...place.querySelectorAll("button")].find((b) =>
    b.textContent?.includes("Show all"),
  );
  click(all ?? null);
  expect(pre()).toBe(text);
});

test("words are found whatever their case", () => {
  expect(placesOf("A cup, a CUP", "cup")).toEqual([
    { start: 2, length: 3 },
    { start: 9, length: 3 },
  ]);
  expect(placesOf("a cup", "")).toEqual([]);
});

test("numbers are greys, bytes in threes are colours", () => {
  const grey = { items: [0, 10], shape: [1, 2], steps: [1, 1], dtype: "float64" };
  expect([...pixelsOf(grey)]).toEqual([0, 0, 0, 255, 255, 255, 255, 255]);
  const colour = { items: [1, 2, 3], shape: [1, 1, 3], steps: [1, 1, 1], dtype: "uint8" };
  expect([...pixelsOf(colour)]).toEqual([1, 2, 3, 255]);
});
