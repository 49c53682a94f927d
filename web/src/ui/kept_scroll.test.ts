// @vitest-environment happy-dom
import { expect, test } from "vitest";
import { KeptScroll } from "./kept_scroll.ts";

function scrolledTo(top: number): { readonly root: HTMLElement; readonly list: HTMLElement } {
  const root = document.createElement("div");
  const list = document.createElement("div");
  root.append(list);
  document.body.append(root);
  list.scrollTop = top;
  return { root, list };
}

test("what is out of the document for a while is scrolled to where it was", () => {
  const { root, list } = scrolledTo(120);
  const kept = new KeptScroll();
  kept.note(list);
  root.remove();
  list.scrollTop = 0;
  kept.note(list);
  document.body.append(root);
  kept.restore(root);
  expect(list.scrollTop).toBe(120);
});

test("what stays at its end is left alone, and what is gone forgotten", () => {
  const { root, list } = scrolledTo(120);
  const kept = new KeptScroll();
  list.dataset["follow"] = "true";
  kept.note(list);
  list.scrollTop = 0;
  kept.restore(root);
  expect(list.scrollTop).toBe(0);
  delete list.dataset["follow"];
  list.scrollTop = 90;
  kept.note(list);
  list.remove();
  list.scrollTop = 0;
  kept.restore(root);
  expect(list.scrollTop).toBe(0);
});
