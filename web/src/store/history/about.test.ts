import { expect, test } from "vitest";
import { events } from "../testing/events.ts";
import { callAbout } from "./about.ts";
import { Calls } from "./calls.ts";
import { Journal } from "./journal.ts";

test("an event is about the call that begins or ends by it, whatever continues beside it", () => {
  const journal = new Journal();
  const entries = events(`> R
    > R/A
    > R/A/X
    > R/B
    > R/B/Y
    < R/A/X aborted
    > R/A/X`);
  journal.add(entries, entries.length + 1);
  const calls = new Calls(journal);
  calls.follow();
  const about = entries.map((_, index) => calls.path(callAbout(calls, index)));
  expect(about).toEqual(["R", "R/A", "R/A/X", "R/B", "R/B/Y", "R/A/X", "R/A/X"]);
  expect(calls.begin(callAbout(calls, 5))).toBe(2);
  expect(calls.begin(callAbout(calls, 6))).toBe(6);
});
