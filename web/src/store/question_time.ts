/** How long there still is time to answer a question of a state. */

import type { Question } from "../model/generated/protocol.ts";
import type { Page } from "./page.ts";
import { askedQuestions } from "./questions.ts";
import type { Watch } from "./run.ts";
import { elapsedNow } from "./run_clock.ts";

type Asking = Pick<Watch, "now" | "journal" | "grown">;

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

/** The question whose time is over first, those without a deadline last; null if nothing is asked. */
export function mostUrgent(
  page: Pick<Page, "server">,
  watch: Asking,
  questions: readonly Question[],
  now_ms: number,
): { readonly question: Question; readonly left_ms: number | null } | null {
  const all = questions.map((question) => ({
    question,
    left_ms: timeLeft(page, watch, question, now_ms),
  }));
  const rank = ({ left_ms }: (typeof all)[number]) => left_ms ?? Number.POSITIVE_INFINITY;
  return all.reduce<(typeof all)[number] | null>(
    (first, each) => (first === null || rank(each) < rank(first) ? each : first),
    null,
  );
}
