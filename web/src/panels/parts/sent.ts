/** Texts about the commands that this page sent. Pending commands are listed at once. Applied ones disappear after a short time;
 * all others stay until the user closes them. */

import type { Command, OpenCommand } from "../../model/generated/protocol.ts";
import type { SentCommand } from "../../store/history/run.ts";
import { dataSize } from "./data_size.ts";
import { duration } from "./duration.ts";

/** Pending command at a station, for a remote robot. */
export interface CommandOnTheWay extends OpenCommand {
  readonly isRobotHeard: boolean;
}

export interface SentLine {
  readonly id: string;
  readonly command: Command;
  readonly kind: "sent" | "applied" | "refused" | "expired" | "lost";
  readonly words: string;
}

/** Display time of applied commands after their response, in ms. */
const APPLIED_MS = 2_500;
/** Maximum number of lines. The newest are shown. */
const LINES_MAX = 5;

export function sentLines(
  sent: readonly SentCommand[],
  dismissed: ReadonlySet<string>,
  now_ms: number,
  answeredBy: (question: number) => string | null = () => null,
  onTheWay: (id: string) => CommandOnTheWay | null = () => null,
): readonly SentLine[] {
  const wanted = sent.filter(({ id, answer, answered_ms, sent_ms }) =>
    answer?.answer === "applied"
      ? now_ms - (answered_ms ?? sent_ms) < APPLIED_MS
      : !dismissed.has(id),
  );
  return wanted.slice(-LINES_MAX).map((each) => ({
    id: each.id,
    command: each.command,
    kind: each.answer?.answer ?? "sent",
    words: lateAnswer(each, answeredBy) ?? words(each, now_ms, onTheWay(each.id)),
  }));
}

/** Text for a response to a question that another user's response preceded. */
function lateAnswer(
  { command, answer }: SentCommand,
  answeredBy: (question: number) => string | null,
): string | null {
  if (command.type !== "answer_question" || answer?.answer !== "refused") return null;
  const other = answeredBy(command.question);
  return other === null ? null : `was no longer needed: ${other} has already answered`;
}

function words(
  { answer, sent_ms, expiry_ms }: SentCommand,
  now_ms: number,
  open: CommandOnTheWay | null,
): string {
  switch (answer?.answer) {
    case "applied":
      return "was carried out";
    case "refused":
      return `was refused: ${answer.reason}`;
    case "expired":
      return "expired and was not carried out";
    case "lost":
      return `got no answer; it is unknown whether it was carried out: ${answer.reason}`;
    default: {
      const ago = `sent ${(Math.max(0, now_ms - sent_ms) / 1_000).toFixed(1)} s ago`;
      if (open !== null) return `${ago}, ${underWay(open, now_ms - sent_ms)}`;
      if (now_ms <= expiry_ms) return `${ago}, not answered yet`;
      return `${ago}, expired without an answer: checking whether it was carried out`;
    }
  }
}

/** Progress of a command to a remote robot, as far as the station knows. */
function underWay(
  { stage, sent_ms, arrives_ms, not_before_ms, progress, isRobotHeard, ...way }: CommandOnTheWay,
  since_ms: number,
): string {
  if (stage === "overdue") {
    return "its time is over; it is unknown whether it was carried out, and the robot is asked";
  }
  if (stage === "started") return "the run has it; its answer is on the way";
  const wait_ms = (not_before_ms ?? 0) - sent_ms - since_ms;
  if (stage === "received" && wait_ms > 0) {
    return `the robot has it and waits ${(wait_ms / 1_000).toFixed(1)} s until its time`;
  }
  if (stage === "received") return "the robot has it";
  if (way.send_at_ms !== undefined) {
    const contact_ms = way.send_at_ms - sent_ms - since_ms;
    if (contact_ms > 0)
      return `planned for the next contact in ${duration(contact_ms)}${effect(way)}`;
  }
  if (!isRobotHeard) return "resent until confirmed; no signal from the robot";
  if (progress && progress.arrived_bytes < progress.bytes) {
    const percent = Math.floor((100 * progress.arrived_bytes) / progress.bytes);
    return `${percent} % of ${dataSize(progress.bytes)} has arrived at the robot`;
  }
  if (arrives_ms === null) return "in flight; the delay is unknown";
  const left_ms = arrives_ms - sent_ms - since_ms;
  if (left_ms > 0) return `in flight; at the robot in about ${(left_ms / 1_000).toFixed(1)} s`;
  return "should be at the robot; no answer yet";
}

/** Time between the start of the contact and the effect. */
function effect({ send_at_ms, effect_ms }: Pick<OpenCommand, "send_at_ms" | "effect_ms">): string {
  if (effect_ms === undefined) return "; time of effect unknown: delay not measured yet";
  return `; takes effect ${duration(effect_ms - (send_at_ms ?? effect_ms))} after its begin`;
}
