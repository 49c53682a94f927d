/** How long there still is time to answer a question of a state. */

import type { Question } from "../../model/generated/protocol.ts";
import { askedQuestions } from "../history/questions.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";
import { elapsedNow } from "./run_clock.ts";

type Asking = Pick<Watch, "now" | "journal" | "journalVersion">;

/** Whole seconds that are left now, whatever moment is shown, in ms; null without a deadline, or before it is known when it was asked. A signal's reader. */
export function timeLeft(
  page: Pick<Page, "server">,
  watch: Asking,
  { id, timeout_ms }: Question,
  now_ms: number,
): number | null {
  const asked_ns = askedQuestions(watch).value.since_ns.get(id);
  if (timeout_ms === null || asked_ns === undefined) return null;
  const left_ms = timeout_ms + asked_ns / 1e6 - elapsedNow(page, watch, now_ms);
  return Math.max(0, Math.ceil(left_ms / 1_000)) * 1_000;
}

/** Those whose time is over first come first, those without a deadline last; else as they were asked. A signal's reader. */
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
