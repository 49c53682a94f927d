import { expect, test } from "vitest";
import type { Event } from "../../model/generated/protocol.ts";
import { Journal } from "../../store/history/journal.ts";
import { events } from "../../store/testing/events.ts";
import { happenedInWords } from "./happened.ts";

const nameOf = (path: string) => (path === "R/A" ? "Look" : path);

function words(entries: Parameters<Journal["add"]>[0]): readonly string[] {
  const journal = new Journal();
  journal.add(entries, entries.length + 1);
  return Array.from({ length: journal.length }, (_, index) => {
    const entry = journal.at(index);
    return entry ? happenedInWords(entry, nameOf) : "";
  });
}

test("events are told in words, with names", () => {
  const entries = events(`> R/A
    < R/A seen
    > R/A!
    < R/A!
    ! R/A careful
    x R/A
    crash`);
  expect(words(entries)).toEqual([
    "Look entered",
    "Look ended with seen",
    "Look entered backwards",
    "Look undone",
    "Look: careful",
    "Look dropped",
    "Resumed after a crash: killed",
  ]);
});

test("a command says who gave it, and whether it was refused", () => {
  const envelope = {
    id: "1",
    author: "anna",
    decided_on: null,
    expiry: null,
    command: { type: "step_into", branch: null },
  } as const;
  const commanded = (answer: Event & { type: "commanded" }): readonly string[] =>
    words([{ sequence: 1, t_ns: 0, event: answer }]);
  expect(commanded({ type: "commanded", envelope, answer: { answer: "applied" } })).toEqual([
    "Command step into by anna",
  ]);
  const refused = { answer: "refused", reason: "no" } as const;
  expect(commanded({ type: "commanded", envelope, answer: refused })).toEqual([
    "Command step into by anna (refused)",
  ]);
});
