// @vitest-environment happy-dom
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { afterEach, expect, test } from "vitest";
import { runLine } from "../store/testing/watched.ts";
import { unmount } from "../ui/testing/mounted.tsx";
import { RunControls } from "./run_controls.tsx";
import { shown } from "./testing/shown.tsx";

const LOOKS = readFileSync(join(import.meta.dirname, "run_controls.css"), "utf8");

afterEach(() => {
  unmount();
  document.head.replaceChildren();
});

test("Start is green, but not beside a run in progress", () => {
  const style = document.createElement("style");
  style.textContent = `:root { --running: green; --text-soft: grey } ${LOOKS}`;
  document.head.append(style);
  const colours = (["finished", "live"] as const).map((phase) => {
    const { place } = shown(() => <RunControls />, { runs: [runLine(phase)] });
    const start = place.querySelector(".run-start button");
    return start && getComputedStyle(start).color;
  });
  expect(colours).toEqual(["green", "grey"]);
});
