// @vitest-environment happy-dom
import fc from "fast-check";
import type { ReactElement } from "react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { CellEditor } from "./cell_editor.tsx";
import { keepCompositions } from "./composition.ts";
import { Dialog } from "./dialog.tsx";
import { TextField } from "./field.tsx";
import { mount, press, settled, type, unmount } from "./testing/mounted.tsx";

let stop = () => {};
beforeEach(() => {
  stop = keepCompositions(window);
});
afterEach(() => {
  stop();
  unmount();
});

type Report = (what: string) => null;

/** Every kind of field of the page. */
const FIELDS: Readonly<Record<string, (report: Report) => ReactElement>> = {
  text: (report) => (
    <TextField label="Name" value="old" onCommit={report} onKeyDown={() => report("key")} />
  ),
  search: (report) => (
    <TextField
      label="Find"
      type="search"
      value="old"
      onInput={() => {}}
      onKeyDown={() => report("key")}
    />
  ),
  cell: (report) => (
    <CellEditor
      label="Name"
      value="old"
      check={() => null}
      onCommit={report}
      onStop={() => report("stop")}
    />
  ),
  plain: (report) => <input onKeyDown={() => report("key")} />,
  "in a dialog": (report) => (
    <Dialog title="Name" onClose={() => report("close")}>
      <TextField label="Name" value="old" onCommit={report} />
    </Dialog>
  ),
};

const composed = fc.oneof(
  fc.constant({ isComposing: true }),
  fc.constant({ keyCode: 229 }),
  fc.constant({ isComposing: true, keyCode: 229 }),
);

test("no field takes a key of an input method, and each takes the same key afterwards", async () => {
  const one = fc.record({
    field: fc.constantFrom(...Object.keys(FIELDS)),
    key: fc.constantFrom("Enter", "Escape", "Tab", "ArrowDown", "Process"),
    how: composed,
  });
  await fc.assert(
    fc.asyncProperty(one, async ({ field, key, how }) => {
      const report = vi.fn(() => null);
      const place = mount(FIELDS[field]?.(report) ?? <span />);
      const input = place.querySelector("input");
      await type(input, "にほ");
      press(input, key, how);
      await settled();
      expect(report).not.toHaveBeenCalled();
      expect(input?.value).toBe("にほ");
      press(input, "Enter");
      await settled();
      expect(report).toHaveBeenCalled();
    }),
  );
});

test("the editor of scripts follows compositions itself", () => {
  const report = vi.fn();
  const place = mount(
    <div className="cm-editor">
      <input onKeyDown={report} />
    </div>,
  );
  press(place.querySelector("input"), "Enter", { isComposing: true });
  expect(report).toHaveBeenCalledTimes(1);
});
