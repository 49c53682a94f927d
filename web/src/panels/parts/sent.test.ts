import { expect, test } from "vitest";
import type { SentCommand } from "../../store/history/run.ts";
import { type CommandOnTheWay, sentLines } from "./sent.ts";

const NOW_MS = 100_000;
const STOP = { id: "1", command: { type: "stop" } } as const;

function line(answer: SentCommand["answer"], ago_ms = 800, dismissed: readonly string[] = []) {
  const sent_ms = NOW_MS - ago_ms;
  const answered_ms = answer && sent_ms;
  const sent: SentCommand = { ...STOP, sent_ms, expiry_ms: sent_ms + 10_000, answer, answered_ms };
  const [found] = sentLines([sent], new Set(dismissed), NOW_MS);
  return found && `${found.kind}: ${found.words}`;
}

test("a command under way says since when, and never that it is done", () => {
  expect(line(null)).toBe("sent: sent 0.8 s ago, not answered yet");
  expect(line(null, 12_000)).toBe(
    "sent: sent 12.0 s ago, expired without an answer: checking whether it was carried out",
  );
});

test("a command to a robot far away says how far it is, as far as the station knows", () => {
  const times = { sent_ms: NOW_MS - 500, expiry_ms: NOW_MS + 9_500, answered_ms: null };
  const sent: SentCommand = { ...STOP, ...times, answer: null };
  const wordsFor = (way: Partial<CommandOnTheWay>) => {
    const plain = {
      id: "ana/1",
      asks: "stop",
      stage: "sent",
      sent_ms: 0,
      arrives_ms: null,
    } as const;
    const onTheWay = () => ({ ...plain, isRobotHeard: true, ...way });
    return sentLines([sent], new Set(), NOW_MS, undefined, onTheWay)[0]?.words;
  };
  expect(wordsFor({})).toBe("sent 0.5 s ago, in flight; the delay is unknown");
  expect(wordsFor({ arrives_ms: 2_000 })).toBe(
    "sent 0.5 s ago, in flight; at the robot in about 1.5 s",
  );
  expect(wordsFor({ arrives_ms: 400 })).toBe(
    "sent 0.5 s ago, should be at the robot; no answer yet",
  );
  expect(wordsFor({ arrives_ms: 2_000, isRobotHeard: false })).toBe(
    "sent 0.5 s ago, resent until confirmed; no signal from the robot",
  );
  const progress = { arrived_bytes: 1_300, bytes: 2_900 };
  expect(wordsFor({ arrives_ms: 2_000, progress })).toBe(
    "sent 0.5 s ago, 44 % of 2.9 KB has arrived at the robot",
  );
  const planned = { send_at_ms: 60_500, isRobotHeard: false };
  expect(wordsFor({ ...planned, effect_ms: 62_500 })).toBe(
    "sent 0.5 s ago, planned for the next contact in 1:00; takes effect 2.0 s after its begin",
  );
  expect(wordsFor(planned)).toBe(
    "sent 0.5 s ago, planned for the next contact in 1:00; time of effect unknown: delay not measured yet",
  );
  expect(wordsFor({ stage: "received" })).toBe("sent 0.5 s ago, the robot has it");
  expect(wordsFor({ stage: "received", not_before_ms: 2_000 })).toBe(
    "sent 0.5 s ago, the robot has it and waits 1.5 s until its time",
  );
  expect(wordsFor({ stage: "overdue" })).toBe(
    "sent 0.5 s ago, its time is over; it is unknown whether it was carried out, and the robot is asked",
  );
  expect(wordsFor({ stage: "started" })).toBe(
    "sent 0.5 s ago, the run has it; its answer is on the way",
  );
});

test("what was carried out is shown for a glance", () => {
  expect(line({ answer: "applied" })).toBe("applied: was carried out");
  expect(line({ answer: "applied" }, 2_500)).toBe(undefined);
});

test("what was carried out late is shown as long as what was at once", () => {
  const late: SentCommand = {
    ...STOP,
    sent_ms: NOW_MS - 9_000,
    expiry_ms: NOW_MS + 1_000,
    answer: { answer: "applied" },
    answered_ms: NOW_MS - 100,
  };
  expect(sentLines([late], new Set(), NOW_MS)).toHaveLength(1);
  expect(sentLines([late], new Set(), NOW_MS + 2_400)).toHaveLength(0);
});

test("what was not carried out stays until it was seen", () => {
  expect(line({ answer: "expired" }, 60_000)).toBe("expired: expired and was not carried out");
  expect(line({ answer: "refused", reason: "no" }, 60_000)).toBe("refused: was refused: no");
  expect(line({ answer: "lost", reason: "cut" }, 60_000)).toContain("it is unknown whether");
  expect(line({ answer: "expired" }, 60_000, ["1"])).toBe(undefined);
});

test("an answer that came after that of someone else says who has answered", () => {
  const command = { type: "answer_question", question: 4, value: { button: 0 } } as const;
  const answer = { answer: "refused", reason: "bob holds control of this run" } as const;
  const times = { sent_ms: NOW_MS, expiry_ms: NOW_MS, answered_ms: NOW_MS };
  const words = (by: string | null) =>
    sentLines([{ id: "2", command, answer, ...times }], new Set(), NOW_MS, () => by)[0]?.words;
  expect(words("bob")).toBe("was no longer needed: bob has already answered");
  expect(words(null)).toBe("was refused: bob holds control of this run");
});
