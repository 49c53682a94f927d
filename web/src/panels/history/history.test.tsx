// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import { runLine, watched } from "../../store/testing/watched.ts";
import { unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { RunHistory } from "./history.tsx";

afterEach(unmount);

test("the run history has a head over each column", () => {
  const { watch, tell } = watched(runLine("finished"));
  tell({ type: "entered", path: "R" }, { type: "left", path: "R", outcome: { id: 0, name: "ok" } });
  const place = shown(<RunHistory />, { watch });
  /** What stands in a row, each by its column. */
  const cells = (row: string) =>
    ["name", "when", "long", "end"].map((column) =>
      [...place.querySelectorAll(`${row} .history-${column}`)].map((cell) => cell.textContent),
    );
  expect(cells(".history-head")).toEqual([["State"], ["Began"], ["Took"], ["Outcome"]]);
  expect(cells(".history-row")).toEqual([["R"], ["T+0.001 s"], ["1.00 ms"], ["ok"]]);
});
