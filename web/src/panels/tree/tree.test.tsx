// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import { unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { StateTree } from "./tree.tsx";

afterEach(unmount);

test("the tree has the children of a state in the order in which they run", () => {
  const machine = `
    R hierarchy outcome done
      A "Last" execution outcome ok
      B "First" execution outcome ok
      R > B
      B.ok > A
      A.ok > R.done`;
  const place = shown(<StateTree />, { machine });
  const names = [...place.querySelectorAll(".state-tree-name")].map((name) => name.textContent);
  expect(names).toEqual(["R", "First", "Last"]);
});
