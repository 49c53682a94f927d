import { expect, test } from "vitest";
import type { Event } from "../../model/generated/protocol.ts";
import { endReasonAt } from "./end_reason.ts";
import { Journal } from "./journal.ts";

const ABORTED = { id: -1, name: "aborted" };

const entered = (path: string) => ({ type: "entered", path, inputs: {} }) as unknown as Event;
const left = (path: string, outcome = ABORTED, error: string | null = null) =>
  ({ type: "left", path, outcome, error }) as unknown as Event;
const log = (path: string, message: string, level = "error") =>
  ({ type: "log", path, message, level }) as unknown as Event;

/** Reason for the end of `R/A`, which the events start and end. */
function reason(...events: readonly Event[]): string | null {
  const journal = new Journal();
  const entries = events.map((event, at) => ({ sequence: at + 1, t_ns: at, event }));
  journal.add(entries, entries.length + 1);
  const found = endReasonAt(journal, "R/A", 0, entries.length - 1);
  return found && `${found.path}: ${found.text}`;
}

test("an error is the reason, else the last error that the state logged", () => {
  expect(reason(entered("R/A"), left("R/A", ABORTED, "no box"))).toBe("R/A: no box");
  const wrong = log("R/A", "has no outcome “done”");
  expect(reason(entered("R/A"), wrong, left("R/A"))).toBe("R/A: has no outcome “done”");
  expect(reason(entered("R/A"), log("R/A", "slips", "warning"), left("R/A"))).toBeNull();
});

test("what was done to a state is the reason: a forced end, a cut", () => {
  const forced = { type: "forced", path: "R/A", outcome: ABORTED } as unknown as Event;
  expect(reason(entered("R/A"), forced, left("R/A"))).toBe(
    "R/A: it was forced to end with aborted",
  );
  const cut = { type: "cut_off", path: "R/A", grace_ms: 2_000 } as unknown as Event;
  expect(reason(entered("R/A"), cut, left("R/A"))).toBe(
    "R/A: ignored its preemption and was cut off after 2 s",
  );
});

test("a container has the reason of the state inside that ended it, not of one whose failure was handled", () => {
  const inner = [entered("R/A/B"), log("R/A/B", "no box"), left("R/A/B")];
  expect(reason(entered("R/A"), ...inner, left("R/A"))).toBe("R/A/B: no box");
  const handled = [...inner, entered("R/A/C"), left("R/A/C", { id: 0, name: "success" })];
  expect(reason(entered("R/A"), ...handled, left("R/A"))).toBeNull();
  expect(reason(entered("R/A"), log("R/X", "another branch"), left("R/A"))).toBeNull();
});
