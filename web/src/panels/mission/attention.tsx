/** Line that is always visible and shows what needs a person: questions with the shortest remaining time, decisions after a
 * crash, and events. A click leads to the details. */

import { CircleHelp, OctagonAlert, TriangleAlert } from "lucide-react";
import type { MouseEvent } from "react";
import { isHeldByLoss } from "../../model/run_words.ts";
import { openQuestions } from "../../store/history/questions.ts";
import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { openFailures } from "../../store/run/acknowledged.ts";
import { openDecisions } from "../../store/run/decisions.ts";
import { byUrgency, timeLeft } from "../../store/run/question_time.ts";
import { isSameRecord, useComputed, useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { duration } from "../parts/duration.ts";
import { isSoon } from "../parts/question.tsx";
import { useRunAge } from "../run_age.ts";
import { countInWords } from "./events.tsx";
import { LinkAge } from "./link_age.tsx";

export function Attention({ watch }: { readonly watch: Watch }) {
  const questions = useComputed(() => openQuestions(watch).length, [watch]);
  const decisions = useComputed(() => openDecisions(watch), [watch]);
  const { length } = useSignal(openFailures(watch));
  const { page } = useHost().context();
  const { isOld } = useRunAge(page, watch);
  const isLost = useComputed(() => {
    const now = watch.now.value;
    return now?.snapshot ? isHeldByLoss(now.snapshot) : false;
  }, [watch]);
  const isDiverged = useComputed(() => watch.now.value?.run.phase === "diverged", [watch]);
  return (
    <div className="mission-alerts">
      <span className="visually-hidden" role="status">
        {askedInWords(questions)}
        {decisions > 0 ? ` ${decisionsInWords(decisions)} to make after a crash` : ""}
      </span>
      {questions > 0 && <Asked watch={watch} count={questions} />}
      {decisions > 0 && <ToDecide count={decisions} />}
      {length > 0 && <ToAcknowledge count={length} />}
      {isLost && <p className="mission-alert">Paused by a lost link: resume to continue</p>}
      {questions + decisions + length === 0 && !isLost && !isOld && !isDiverged && (
        <p className="mission-soft">Nothing to decide</p>
      )}
      <LinkAge watch={watch} />
    </div>
  );
}

function Asked({ watch, count }: { readonly watch: Watch; readonly count: number }) {
  const { page } = useHost().context();
  const { id, left_ms } = useComputed(
    () => {
      const [first] = byUrgency(watch, openQuestions(watch));
      const left_ms = first ? timeLeft(page, watch, first, clock1s.value) : null;
      return { id: first?.id ?? 0, left_ms };
    },
    [page, watch],
    isSameRecord,
  );
  return (
    <button
      type="button"
      className={`mission-alert ${isSoon(left_ms) ? "mission-alert-soon" : ""}`}
      title="Show the most urgent question"
      onClick={(event) => show(event, `[data-question="${id}"]`)}
    >
      <CircleHelp size={18} aria-hidden />
      {count === 1 ? "1 question" : `${count} questions`}
      {left_ms !== null && <span className="mission-alert-left">{duration(left_ms)}</span>}
    </button>
  );
}

function ToDecide({ count }: { readonly count: number }) {
  return (
    <button
      type="button"
      className="mission-alert mission-alert-crash"
      title="Show decisions to make after the crash"
      onClick={(event) => show(event, ".mission-crash")}
    >
      <OctagonAlert size={18} aria-hidden />
      {decisionsInWords(count)}
    </button>
  );
}

function decisionsInWords(count: number): string {
  return count === 1 ? "1 decision" : `${count} decisions`;
}

function ToAcknowledge({ count }: { readonly count: number }) {
  return (
    <button
      type="button"
      className="mission-alert mission-alert-event"
      title="Show the failures"
      onClick={(event) => show(event, ".mission-events")}
    >
      <TriangleAlert size={18} aria-hidden />
      {countInWords(count)} {count === 1 ? "event" : "events"}
    </button>
  );
}

/** Scrolls a part of mission control into view, and focuses its first control. */
function show({ currentTarget }: MouseEvent<HTMLElement>, part: string): void {
  const place = currentTarget.closest(".mission")?.querySelector<HTMLElement>(part);
  if (!place) return;
  place.scrollIntoView({ block: "start" });
  const first = place.querySelector<HTMLElement>("input:enabled, textarea:enabled, button:enabled");
  first?.focus({ preventScroll: true });
}

function askedInWords(count: number): string {
  if (count === 0) return "";
  return count === 1 ? "1 unanswered question" : `${count} unanswered questions`;
}
