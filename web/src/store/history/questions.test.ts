import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Event, Question } from "../../model/generated/protocol.ts";
import { Journal } from "./journal.ts";
import { askedQuestions } from "./questions.ts";

function question(id: number): Question {
  const form = { type: "buttons", buttons: ["yes", "no"] } as const;
  const buttons = { ...form, buttons: [...form.buttons] };
  return { id, path: "R/A", message: "Empty?", form: buttons, timeout_ms: 1_000, default: null };
}

function closed(id: number, author: string): Event {
  return { type: "closed", id, how: "answered", answer: { button: 0 }, author };
}

test("a question is known from when it was asked until someone answers it, and then by whom", () => {
  const journal = new Journal();
  const journalVersion = signal(0);
  const asked = askedQuestions({ journal, journalVersion });
  const tell = (...events: readonly Event[]) => {
    const from = journal.next;
    const entries = events.map((event, at) => {
      const sequence = from + at;
      return { sequence, t_ns: sequence * 10, event };
    });
    journal.add(entries, from + events.length);
    journalVersion.value = journal.length;
  };
  tell({ type: "asked", question: question(7) }, { type: "asked", question: question(8) });
  expect([...asked.value.since_ns]).toEqual([
    [7, 10],
    [8, 20],
  ]);
  tell(closed(7, "anna"));
  const before = asked.value;
  expect([...before.since_ns.keys()]).toEqual([8]);
  expect(before.closed.map(({ question: { id }, author, t_ns }) => [id, author, t_ns])).toEqual([
    [7, "anna", 30],
  ]);
  tell({ type: "entered", path: "R/B" });
  expect(asked.value).toBe(before);
});

test("of more than twenty ended questions the oldest goes", () => {
  const journal = new Journal();
  const ids = Array.from({ length: 21 }, (_, at) => at + 1);
  const events = ids.flatMap((id): Event[] => [
    { type: "asked", question: question(id) },
    closed(id, "anna"),
  ]);
  const entries = events.map((event, at) => ({ sequence: at + 1, t_ns: at, event }));
  const ended = (count: number) => {
    journal.add(entries.slice(0, 2 * count), 2 * count + 1);
    const { closed } = askedQuestions({ journal, journalVersion: signal(0) }).value;
    return [closed.length, closed[0]?.question.id, closed.at(-1)?.question.id];
  };
  expect(ended(20)).toEqual([20, 20, 1]);
  expect(ended(21)).toEqual([20, 21, 2]);
});
