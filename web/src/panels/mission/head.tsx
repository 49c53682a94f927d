/** What a glance has to tell: which mission, how it stands, how long, and how old all this is. */

import { History, Unplug, Wifi } from "lucide-react";
import { runStand, summaryStand } from "../../model/run_words.ts";
import { isGoingOn, type RunAge, runAge } from "../../store/age.ts";
import { openQuestions } from "../../store/questions.ts";
import type { Watch } from "../../store/run.ts";
import { elapsedAt } from "../../store/run_clock.ts";
import { summaryOf } from "../../store/running.ts";
import { seconds } from "../../store/seconds.ts";
import { earlierRuns, expectedLength } from "../../store/usual.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useCommand, useHost } from "../context.tsx";
import { duration, growing } from "../parts/duration.ts";
import { useRunAge } from "../run_age.ts";
import { Identity } from "./identity.tsx";
import { isGoingOn as isSummaryGoingOn } from "./no_run.tsx";
import { StatusWord } from "./status_word.tsx";

export function Head({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const now = useSignal(watch.now);
  const summary = useComputed(() => summaryOf(page, watch), [page, watch]);
  const asked = useComputed(() => askedInWords(openQuestions(watch).length), [watch]);
  const stand = now ? runStand(now) : summary && summaryStand(summary);
  return (
    <div className="mission-head">
      <div className="mission-title">
        <h2 title={watch.id}>{summary?.name ?? watch.id}</h2>
        <OtherRuns watch={watch} />
      </div>
      <div className="mission-status shows-run">
        {stand && (
          <span className="mission-status-word" role="status" aria-label="How the run stands">
            <StatusWord stand={stand} size={26} />
          </span>
        )}
        <Times watch={watch} />
      </div>
      {stand && stand.word !== "finished" && (
        <p className="mission-detail">
          {[stand.detail, asked].filter((text) => text !== "").join("; ")}
        </p>
      )}
      {now?.snapshot?.journal_problem && (
        <p className="mission-alert">
          The journal cannot be written: {now.snapshot.journal_problem}
        </p>
      )}
      <LinkAge watch={watch} />
      <Identity />
    </div>
  );
}

/** The time since the start beside what earlier runs took. */
function Times({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const elapsed = useComputed(() => {
    const now_ms = seconds.value;
    const age = runAge(page, watch, now_ms);
    const elapsed_ms = elapsedAt(page, watch, age.isOld ? now_ms - age.age_ms : now_ms);
    const now = watch.now.value;
    return now && isGoingOn(now) ? growing(elapsed_ms) : duration(elapsed_ms);
  }, [page, watch]);
  const expected = useComputed(() => {
    const length_ms = expectedLength(earlierRuns(page, watch));
    return length_ms === null ? null : duration(length_ms);
  }, [page, watch]);
  return (
    <dl className="mission-times">
      <div>
        <dt>elapsed</dt>
        <dd>{elapsed}</dd>
      </div>
      {expected !== null && (
        <div title="Half of the earlier runs of this machine took no longer.">
          <dt>usually</dt>
          <dd>{expected}</dd>
        </div>
      )}
    </dl>
  );
}

/** How the connection is, and how old what is shown may be. */
function LinkAge({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const run = useCommand();
  const pulse = useSignal(page.server.pulse);
  const phase = useComputed(() => watch.now.value?.run.phase, [watch]);
  const age = useRunAge(page, watch);
  if (age.why === "moment") {
    return (
      <p className="mission-link mission-link-past">
        <History size={16} aria-hidden />
        <span>
          Branches show the past, {duration(age.age_ms)} before the newest event. Status, questions
          and buttons are live.
        </span>
        <Button onClick={() => run("run.live")}>Back to now</Button>
      </p>
    );
  }
  if (age.isOld) {
    return (
      <p className="mission-link mission-link-old" role="alert">
        <Unplug size={16} aria-hidden />
        <span>{oldInWords(age)}</span>
      </p>
    );
  }
  const delay = pulse?.delay_ms == null ? "" : ` (${Math.max(1, Math.round(pulse.delay_ms))} ms)`;
  const isLive = phase === "live" || phase === "starting";
  return (
    <p className="mission-link">
      <Wifi size={16} aria-hidden />
      <span>
        {isLive
          ? `Live: server and robot are heard${delay}`
          : "The run is over: this stays as it is"}
      </span>
    </p>
  );
}

function askedInWords(count: number): string {
  if (count === 0) return "";
  return count === 1 ? "a question waits for an answer" : `${count} questions wait for answers`;
}

function oldInWords({ why, age_ms }: RunAge): string {
  const who = why === "link" ? "The server is not heard" : "The server does not hear the robot";
  return `${who}: what you see is ${duration(age_ms)} old.`;
}

/** Other runs that go on, one press away. */
function OtherRuns({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const run = useCommand();
  const all = useSignal(page.runs.all);
  const others = all.filter((one) => one.id !== watch.id && isSummaryGoingOn(one));
  if (others.length === 0) return null;
  return (
    <label className="mission-switch">
      <span className="visually-hidden">Other runs that go on</span>
      <select value="" onChange={(event) => run("run.show", event.currentTarget.value)}>
        <option value="" disabled>
          {others.length === 1 ? "1 other run" : `${others.length} other runs`}
        </option>
        {others.map(({ id, name, started_ms }) => (
          <option key={id} value={id}>
            {name}, began {new Date(started_ms).toLocaleTimeString()}
          </option>
        ))}
      </select>
    </label>
  );
}
