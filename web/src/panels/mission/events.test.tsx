// @vitest-environment happy-dom
import { act } from "react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { Event } from "../../model/generated/protocol.ts";
import { runLine, watched } from "../../store/testing/watched.ts";
import { SLIP_MS } from "../../ui/confirm_press.ts";
import { unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { Events } from "./events.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

function warning(path: string): Event {
  return { type: "log", path, level: "warning", stream: "logger", message: "slips" };
}

test("a line that counts up can be acknowledged all the while, and only another line makes it wait", () => {
  const { watch, tell } = watched(runLine("finished"));
  tell(warning("R/A"));
  const place = shown(<Events watch={watch} />, { watch });
  /** Each line with its count and, while its button waits, a dash. */
  const lines = () =>
    [...place.querySelectorAll("li")].map((line) => {
      const isOff = line.querySelector(".button")?.getAttribute("aria-disabled") === "true";
      const count = line.querySelector(".mission-count")?.textContent ?? "×1";
      return `${line.querySelector(".mission-event-where")?.textContent} ${count}${isOff ? " –" : ""}`;
    });
  const button = place.querySelector("li .button");
  expect(lines()).toEqual(["A ×1"]);
  act(() => tell(warning("R/A")));
  expect(lines()).toEqual(["A ×2"]);
  expect(place.querySelector("li .button")).toBe(button);
  act(() => tell(warning("R/B")));
  expect(lines()).toEqual(["B ×1 –", "A ×2 –"]);
  act(() => vi.advanceTimersByTime(SLIP_MS));
  expect(lines()).toEqual(["B ×1", "A ×2"]);
  act(() => tell(warning("R/A")));
  expect(lines()).toEqual(["B ×1", "A ×3"]);
});

test("the list says how many older events it dropped", () => {
  const { watch, tell } = watched(runLine("finished", "many"));
  const place = shown(<Events watch={watch} />, { watch });
  const soft = () => [...place.querySelectorAll("section > .mission-soft")].at(-1)?.textContent;
  act(() => tell(...Array.from({ length: 1_000 }, (_, at) => warning(`R/${at}`))));
  expect(soft()).toBe("and 970 older events");
  act(() => tell(warning("R/A")));
  const end = "that nobody acknowledged";
  expect(soft()).toBe(`1 older event ${end} is no longer listed here; the history has them.`);
  act(() => tell(warning("R/B")));
  expect(soft()).toBe(`2 older events ${end} are no longer listed here; the history has them.`);
});
