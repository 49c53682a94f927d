// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import { runLine } from "../../store/testing/watched.ts";
import { unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { Runs } from "./runs.tsx";

afterEach(unmount);

test("the list of runs tells no length of a run in progress, as it would not grow", () => {
  const runs = [runLine("live", "live-1"), runLine("finished", "over-1")];
  const place = shown(<Runs />, { runs });
  const texts = [...place.querySelectorAll(".runs-when")].map((when) => when.textContent ?? "");
  expect(texts.map((text) => text.split(" · ").slice(1))).toEqual([[], ["83 ms"]]);
});
