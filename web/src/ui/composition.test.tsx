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

type Told = (what: string) => null;

/** Every kind of field of the page. */
const FIELDS: Readonly<Record<string, (told: Told) => ReactElement>> = {
  text: (told) => (
    <TextField label="Name" value="old" onCommit={told} onKeyDown={() => told("key")} />
  ),
  search: (told) => (
    <TextField
      label="Find"
      type="search"
      value="old"
      onInput={() => {}}
      onKeyDown={() => told("key")}
    />
  ),
  cell: (told) => (
    <CellEditor
      label="Name"
      value="old"
      check={() => null}
      onCommit={told}
      onStop={() => told("stop")}
    />
  ),
  plain: (told) => <input onKeyDown={() => told("key")} />,
  "in a dialog": (told) => (
    <Dialog title="Name" onClose={() => told("close")}>
      <TextField label="Name" value="old" onCommit={told} />
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
      const told = vi.fn(() => null);
      const place = mount(FIELDS[field]?.(told) ?? <span />);
      const input = place.querySelector("input");
      await type(input, "にほ");
      press(input, key, how);
      await settled();
      expect(told).not.toHaveBeenCalled();
      expect(input?.value).toBe("にほ");
      press(input, "Enter");
      await settled();
      expect(told).toHaveBeenCalled();
    }),
  );
});

test("the editor of scripts follows compositions itself", () => {
  const told = vi.fn();
  const place = mount(
    <div className="cm-editor">
      <input onKeyDown={told} />
    </div>,
  );
  press(place.querySelector("input"), "Enter", { isComposing: true });
  expect(told).toHaveBeenCalledTimes(1);
});
