// @vitest-environment happy-dom
import { createDockview, type DockviewApi } from "dockview-react";
import { expect, test } from "vitest";
import { type LocalStore, memoryStore } from "../store/local_store.ts";
import { DockControl } from "./dock_control.ts";

const LARGE = [1440, 900] as const;
const SMALL = [720, 675] as const;

interface Docked {
  readonly control: DockControl;
  readonly resize: (size: readonly [number, number]) => void;
  /** Of the left, right and lower side: width, width, height. */
  readonly sizes: () => readonly (number | undefined)[];
}

function docked(store: LocalStore, size: readonly [number, number]): Docked {
  const createComponent = () => ({ element: document.createElement("div"), init: () => {} });
  const api: DockviewApi = createDockview(document.createElement("div"), { createComponent });
  const resize = ([width, height]: readonly [number, number]) => api.layout(width, height, true);
  resize(size);
  const control = new DockControl(api, store);
  control.restore("Edit");
  const of = (id: string) => api.getPanel(id)?.group.api;
  const sizes = () => [of("tree")?.width, of("inspector")?.width, of("problems")?.height];
  return { control, resize, sizes };
}

test("sides have their sizes again after the page was small, whether it has grown by then or not", () => {
  for (const isGrown of [true, false]) {
    const { control, resize, sizes } = docked(memoryStore(), LARGE);
    const before = sizes();
    for (let visit = 0; visit < 3; visit += 1) {
      control.fold(true);
      resize(SMALL);
      if (isGrown) resize(LARGE);
      control.fold(false);
      resize(LARGE);
      expect(sizes()).toEqual(before);
    }
  }
});

test("a side that was hidden on a large page takes the same part of a small one, and is as large as before on the large one", () => {
  const { control, resize, sizes } = docked(memoryStore(), LARGE);
  const before = sizes();
  control.layouts.toggle("right");
  resize(SMALL);
  control.layouts.toggle("right");
  expect(sizes()[1]).toBe((before[1] ?? 0) / 2);
  resize(LARGE);
  expect(sizes()).toEqual(before);
});

test("sides have their sizes again after a reload of the small page", () => {
  const store = memoryStore();
  const first = docked(store, LARGE);
  const before = first.sizes();
  first.control.fold(true);
  first.resize(SMALL);
  const { control, resize, sizes } = docked(store, SMALL);
  control.fold(true);
  resize(LARGE);
  control.fold(false);
  expect(sizes()).toEqual(before);
});
