/** Texts about the command list of a robot: when each command is sent, takes effect and expires, and its result after the release. */

import { commandInWords } from "../../model/command_words.ts";
import type { Answer, CommandList, ListLine } from "../../model/generated/protocol.ts";
import { inPageWords } from "../../model/page_words.ts";
import { utcTime } from "../../store/page/times.ts";
import { duration } from "../parts/duration.ts";

/** Status of the list. */
export function listInWords({ released }: CommandList, now_ms: number): string {
  if (released === undefined) return "not released";
  return `released by ${released.user} at ${utcTime(released.at_ms, now_ms)}`;
}

/** Command of a line, with its run if that is not the displayed one. */
export function lineInWords({ listed }: ListLine, shownRun: string): string {
  const words = commandInWords(listed.command);
  return listed.run === shownRun ? words : `${words}, run ${listed.run}`;
}

/** Times of a line before its release, and its result afterwards. */
export function stateInWords(line: ListLine, now_ms: number): string {
  const { fate, effect_ms } = line;
  if (fate === undefined) return times(line, "sent at the release", now_ms);
  if (fate.fate === "answered") return answered(fate.answer);
  switch (fate.stage) {
    case "sent":
      return times(line, "being sent", now_ms);
    case "received":
      return effect_ms === undefined
        ? "the robot has it"
        : `the robot has it, takes effect ${at(effect_ms, now_ms)}`;
    case "started":
      return "the run has it";
    case "overdue":
      return "expired without an answer of the robot";
  }
}

function answered(answer: Answer): string {
  switch (answer.answer) {
    case "applied":
      return "applied";
    case "refused":
      return `refused: ${inPageWords(answer.reason)}`;
    case "expired":
      return "expired, not carried out";
    case "unknown":
      return `unknown whether it was carried out: ${inPageWords(answer.reason)}`;
  }
}

/** Times of a command. An unknown time of effect is never estimated. */
function times({ send_at_ms, effect_ms, expires_ms }: ListLine, now: string, now_ms: number) {
  const sent = send_at_ms === undefined ? now : `sent ${at(send_at_ms, now_ms)}`;
  const effect =
    effect_ms === undefined ? "time of effect unknown" : `takes effect ${at(effect_ms, now_ms)}`;
  const expiry = expires_ms === undefined ? "" : `, expires ${at(expires_ms, now_ms)}`;
  return `${sent}, ${effect}${expiry}`;
}

function at(then_ms: number, now_ms: number): string {
  const time = utcTime(then_ms, now_ms);
  return then_ms > now_ms ? `in ${duration(then_ms - now_ms)}, at ${time}` : `at ${time}`;
}
