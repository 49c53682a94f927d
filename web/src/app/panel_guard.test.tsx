// @vitest-environment happy-dom
import { afterEach, expect, test, vi } from "vitest";
import type { Telling } from "../store/page/notices.ts";
import { mount, settled, unmount } from "../ui/testing/mounted.tsx";
import { PanelGuard } from "./panel_guard.tsx";

afterEach(() => {
  unmount();
  vi.restoreAllMocks();
});

const FAULT = new Error("no such lane");

function Broken(): never {
  throw FAULT;
}

test("a panel that throws shows the message, and leaves its stack in the console and in the log", async () => {
  const written = vi.spyOn(console, "error").mockImplementation(() => {});
  const reported: Telling[] = [];
  const page = { tell: (telling: Telling) => void reported.push(telling) };
  const place = mount(
    <PanelGuard name="Timeline" page={page}>
      <Broken />
    </PanelGuard>,
  );
  await settled();
  expect(place.textContent).toContain("Timeline cannot be shown");
  expect(written).toHaveBeenCalledWith("Timeline cannot be shown", FAULT);
  const [{ text, level, isQuiet } = { text: "", level: "info" }] = reported;
  expect([reported.length, level, isQuiet]).toEqual([1, "error", true]);
  expect(text).toContain("Timeline cannot be shown: Error: no such lane\n    at ");
});
