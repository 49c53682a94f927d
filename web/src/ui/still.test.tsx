// @vitest-environment happy-dom
import { act } from "react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { draw, mount, unmount } from "./mounted.tsx";
import { useStill } from "./still.ts";
import { SLIP_MS } from "./twice.ts";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

function Moving({ at }: { readonly at: string }) {
  return <button type="button" disabled={!useStill(at)} />;
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
