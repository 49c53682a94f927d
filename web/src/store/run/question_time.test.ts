import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Question, RunNow } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import { byUrgency, timeLeft } from "./question_time.ts";

const SAID_MS = 1_000_000;
const page = { server: { pulse: signal({ ahead_ms: 0 }) } } as unknown as Parameters<
  typeof timeLeft
>[0];

function question(id: number, timeout_ms: number | null): Question {
  const form = { type: "buttons" as const, buttons: ["yes"] };
  return { id, path: "R/A", message: "Empty?", form, timeout_ms, default: null };
}

/** A run of 20 s whose questions were asked after 10 s. */
function asking(questions: readonly Question[], playhead: number | null = null) {
  const journal = new Journal();
  const entries = questions.map((each, at) => ({
    sequence: at + 1,
    t_ns: 10e9,
    event: { type: "asked" as const, question: each },
  }));
  journal.add(entries, entries.length + 1);
  const run = { phase: "live", length_ms: 0 };
  const now = { run, snapshot: { elapsed_ms: 20_000 }, snapshot_ms: SAID_MS };
  const shown = { now: signal(now as unknown as RunNow), playhead: signal(playhead) };
  return { ...shown, journal, journalVersion: signal(entries.length) };
}

test("the time that is left for an answer is that of now, also while an earlier moment is shown", () => {
  const asked = question(1, 30_000);
  const left = (playhead: number | null) =>
    timeLeft(page, asking([asked], playhead), asked, SAID_MS + 5_000);
  expect(left(null)).toBe(15_000);
  expect(left(1)).toBe(15_000);
});

test("questions stand in the order in which their times are over; those without a deadline come last", () => {
  const all = [question(1, null), question(2, 60_000), question(3, 25_000), question(4, null)];
  expect(byUrgency(asking(all), all).map(({ id }) => id)).toEqual([3, 2, 1, 4]);
});
