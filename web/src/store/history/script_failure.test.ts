import { expect, test } from "vitest";
import type { Event } from "../../model/generated/protocol.ts";
import { endReasonAt } from "./end_reason.ts";
import { Journal } from "./journal.ts";
import { failureAt } from "./script_failure.ts";

const TRACEBACK = `Traceback (most recent call last):
  File "script.py", line 2, in execute
    pick()
ValueError: no box
`;

/** Failure of `R/A`, this number of events after its traceback. */
function found(many: number): readonly (string | undefined)[] {
  const journal = new Journal();
  const log = { type: "log", path: "R/A", level: "error", stream: "logger" } as const;
  const other: Event = { type: "entered", path: "R/B" };
  const recorded: readonly Event[] = [
    { type: "entered", path: "R/A" },
    { ...log, message: TRACEBACK },
    ...Array.from({ length: many - 1 }, () => other),
    { type: "left", path: "R/A", outcome: { id: -1, name: "aborted" } },
  ];
  const entries = recorded.map((event, at) => ({ sequence: at + 1, t_ns: at, event }));
  journal.add(entries, entries.length + 1);
  const end = entries.length - 1;
  const failure = failureAt(journal, "R/A", 0, end);
  return [failure?.path, endReasonAt(journal, "R/A", 0, end)?.text];
}

test("what happened more than 5,000 events before the end of a state is not taken for its reason", () => {
  expect(found(4_999)).toEqual(["R/A", "ValueError: no box"]);
  expect(found(5_000)).toEqual(["R/A", undefined]);
  expect(found(5_001)).toEqual([undefined, undefined]);
});
