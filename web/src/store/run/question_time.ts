/** Remaining time to answer a question of a state. */

import type { Question } from "../../model/generated/protocol.ts";
import { askedQuestions } from "../history/questions.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { assumedElapsed } from "./data_end.ts";

type Asking = Pick<Watch, "now" | "journal" | "journalVersion">;

/** Remaining time at present, whatever moment is shown: whole seconds, in ms. It also decreases while nothing arrives, because the
 * deadline passes on the robot. Null without a deadline, or while the time of the
 * question is unknown. Reads signals. */
export function timeLeft(
  page: Pick<Page, "server">,
  watch: Asking,
  { id, timeout_ms }: Question,
  now_ms: number,
): number | null {
  const asked_ns = askedQuestions(watch).value.since_ns.get(id);
  if (timeout_ms === null || asked_ns === undefined) return null;
  const left_ms = timeout_ms + asked_ns / 1e6 - assumedElapsed(page, watch, now_ms);
  return Math.max(0, Math.ceil(left_ms / 1_000)) * 1_000;
}

/** Sorts questions by deadline, those without one last; equal ones in the order in which they were asked. Reads signals. */
export function byUrgency(
  watch: Pick<Watch, "journal" | "journalVersion">,
  questions: readonly Question[],
): readonly Question[] {
  const { since_ns } = askedQuestions(watch).value;
  const end_ms = ({ id, timeout_ms }: Question) => {
    const asked_ns = since_ns.get(id);
    const isKnown = timeout_ms !== null && asked_ns !== undefined;
    return isKnown ? asked_ns / 1e6 + timeout_ms : Number.MAX_VALUE;
  };
  return [...questions].sort((one, other) => end_ms(one) - end_ms(other));
}
