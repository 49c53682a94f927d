// @vitest-environment happy-dom
import { act } from "react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { SLIP_MS } from "./confirm_press.ts";
import { useStableFor } from "./stable_for.ts";
import { draw, mount, unmount } from "./testing/mounted.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

function Moving({ at }: { readonly at: string }) {
  return <button type="button" disabled={!useStableFor(at)} />;
}

test("a button that has moved waits until a press on it can be meant", () => {
  const button = mount(<Moving at="1" />).querySelector("button");
  expect(button?.disabled).toBe(false);
  draw(<Moving at="1 2" />);
  expect(button?.disabled).toBe(true);
  act(() => vi.advanceTimersByTime(SLIP_MS - 1));
  expect(button?.disabled).toBe(true);
  act(() => vi.advanceTimersByTime(1));
  expect(button?.disabled).toBe(false);
});
