// @vitest-environment happy-dom
import { EditorState } from "@codemirror/state";
import { expect, test } from "vitest";
import { difference, scriptEditor } from "./script_editor.ts";

test("a text becomes the other by what is different only", () => {
  const become = (before: string, after: string) => {
    const changes = difference(before, after);
    return changes
      ? EditorState.create({ doc: before }).update({ changes }).state.doc.toString()
      : before;
  };
  for (const [before, after] of [
    ["", "a"],
    ["aa", "a"],
    ["a", "aaa"],
    ["abc", "axc"],
    ["abc", ""],
    ["same", "same"],
  ] as const)
    expect(become(before, after)).toBe(after);
  expect(difference("one\ntwo\nthree", "one\n2\nthree")).toEqual({ from: 4, to: 7, insert: "2" });
});

test("what is typed is told, what is put in is not", () => {
  const calls: string[] = [];
  const place = document.body.appendChild(document.createElement("div"));
  const editor = scriptEditor(place, {
    text: "return 0",
    readOnly: false,
    label: "Script of Scan",
    names: () => ({ inputs: [], outputs: [], outcomes: [], globals: [] }),
    check: async () => [],
    onRepair: async () => {},
    onType: (text) => calls.push(text),
    onApply: () => calls.push("applied"),
  });
  editor.put("return 1");
  expect(calls).toEqual([]);
  editor.view.dispatch({ changes: { from: 7, to: 8, insert: "2" }, userEvent: "input.type" });
  expect(calls).toEqual(["return 2"]);
  expect(editor.view.contentDOM.getAttribute("aria-label")).toBe("Script of Scan");
  editor.goTo(99);
  expect(editor.view.state.selection.main.head).toBe(0);
  editor.setReadOnly(true);
  expect(editor.view.state.readOnly).toBe(true);
  editor.view.destroy();
});
