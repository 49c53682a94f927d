// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Button } from "./button.tsx";
import { byRole, mount, press, unmount } from "./testing/mounted.tsx";
import { listenForTips } from "./tips.ts";
import { Tree } from "./tree.tsx";

let stop = () => {};

beforeEach(() => {
  vi.useFakeTimers();
  stop = listenForTips(document);
});

afterEach(() => {
  stop();
  unmount();
  vi.useRealTimers();
});

function finger(target: Element | null | undefined, name: string, more: PointerEventInit = {}) {
  const event = { bubbles: true, pointerType: "touch", isPrimary: true, ...more };
  target?.dispatchEvent(new PointerEvent(name, event));
}

const tip = () => document.querySelector(".tip")?.textContent;

test("a tap on a button that can do nothing says why, until the next one", () => {
  const undo = (
    <Button title="Nothing to undo" disabled onClick={() => {}}>
      Undo
    </Button>
  );
  const button = mount(undo).querySelector("button");
  finger(button, "pointerdown");
  finger(button, "pointerup");
  expect(tip()).toBe("Nothing to undo");
  finger(document.body, "pointerdown");
  expect(tip()).toBeUndefined();
});

test("what the keyboard comes to is explained after a while, until a key is pressed", () => {
  const button = mount(
    <Button title="Nothing to undo" disabled onClick={() => {}}>
      Undo
    </Button>,
  ).querySelector("button");
  if (button) vi.spyOn(button, "matches").mockReturnValue(true);
  button?.focus();
  expect(tip()).toBeUndefined();
  vi.advanceTimersByTime(1_000);
  expect(tip()).toBe("Nothing to undo");
  press(button, "Escape");
  expect(tip()).toBeUndefined();
});

test("a finger that rests on a row asks for its menu, and one that moves does not", () => {
  const ask = vi.fn();
  const place = mount(
    <Tree
      label="Rows"
      roots={["one", "two"]}
      id={(node) => node}
      childrenOf={() => null}
      text={(node) => node}
      expanded={new Set()}
      onExpand={() => {}}
      onMenu={ask}
    />,
  );
  const [, row] = byRole(place, "treeitem");
  finger(row, "pointerdown", { clientX: 10, clientY: 10 });
  finger(row, "pointermove", { clientX: 10, clientY: 60 });
  vi.advanceTimersByTime(1_000);
  expect(ask).not.toHaveBeenCalled();
  finger(row, "pointerdown", { clientX: 10, clientY: 10 });
  vi.advanceTimersByTime(1_000);
  expect(ask.mock.calls).toEqual([["two", { x: 10, y: 10 }]]);
});
