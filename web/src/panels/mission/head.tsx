/** Head of mission control: the mission, its status, and its duration. It has a fixed height, so that the parts below do not move. */

import { isLive, runStatusWords, summaryStatusWords } from "../../model/run_words.ts";
import type { Watch } from "../../store/history/run.ts";
import { clockTimes, missionClock, startedAt } from "../../store/page/times.ts";
import { earlierRuns, expectedLength } from "../../store/run/baseline.ts";
import { elapsedAtDataEnd } from "../../store/run/data_end.ts";
import { summaryOf } from "../../store/run/running.ts";
import { isSameRecord, useComputed, useSignal } from "../../ui/signals.ts";
import { useCommand, useHost } from "../context.tsx";
import { AsOf } from "../parts/as_of.tsx";
import { duration } from "../parts/duration.ts";
import { StatusWord } from "./status_word.tsx";

export function Head({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const now = useSignal(watch.now);
  const summary = useComputed(() => summaryOf(page, watch), [page, watch]);
  const status = now ? runStatusWords(now) : summary && summaryStatusWords(summary);
  const name = summary?.name ?? watch.id;
  return (
    <div className="mission-head">
      <div className="mission-title">
        <h2 title={`${name}, run ${watch.id}`}>{name}</h2>
        <OtherRuns watch={watch} />
      </div>
      <div className="mission-status shows-run">
        {status && (
          <span className="mission-status-word" role="status" aria-label="State of the run">
            <StatusWord status={status} size={26} />
          </span>
        )}
        <p className="mission-detail">{status && status.word !== "finished" && status.detail}</p>
        <Times watch={watch} />
      </div>
      <Clocks watch={watch} />
    </div>
  );
}

/** Time between the start and the shown moment, with the durations of earlier runs. */
function Times({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const elapsed = useComputed(() => {
    const elapsed_ms = elapsedAtDataEnd(page, watch);
    const now = watch.now.value;
    return now?.run.phase === "finished" ? duration(elapsed_ms) : missionClock(elapsed_ms);
  }, [page, watch]);
  const isOver = useComputed(() => watch.now.value?.run.phase === "finished", [watch]);
  const expected = useComputed(() => {
    const found = expectedLength(earlierRuns(page, watch));
    if (found === null) return "";
    return `${found.isMedian ? "usually" : "on average"} ${duration(found.length_ms)}`;
  }, [page, watch]);
  const [, how = "", length = ""] = expected.match(/^(usually|on average) (.*)$/) ?? [];
  return (
    <dl className="mission-times">
      <div>
        <dt>
          {isOver ? "took" : "mission time"}
          <AsOf watch={watch} />
        </dt>
        <dd>{elapsed}</dd>
      </div>
      {length !== "" && (
        <div title={HOW[how]}>
          <dt>{how}</dt>
          <dd>{length}</dd>
        </div>
      )}
    </dl>
  );
}

/** Date and time of the shown moment. */
function Clocks({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const times = useComputed(
    () => {
      const times = clockTimes(watch, elapsedAtDataEnd(page, watch) * 1e6);
      return { ...times, isOver: watch.now.value?.run.phase === "finished" };
    },
    [page, watch],
    isSameRecord,
  );
  const robot = summaryOf(page, watch)?.robot;
  return (
    <p className="mission-clocks shows-run" title={CLOCKS}>
      <span>
        {times.isOver && "ended at "}UTC{" "}
        <time>{times.utc ?? "unknown: a crash stopped the clock of the run"}</time>
        <AsOf watch={watch} />
      </span>
      {times.robot && (
        <span>
          {robot}’s clock <time>{times.robot}</time>
        </span>
      )}
    </p>
  );
}

const CLOCKS =
  "The time of what you see here. View ▸ Times chooses the clock of time line, log and history.";

const HOW: Readonly<Record<string, string>> = {
  usually: "Half of the earlier runs of this machine took this long or less.",
  "on average": "Average of the few earlier runs of this machine that succeeded.",
};

/** Menu of other active runs. */
function OtherRuns({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const run = useCommand();
  const all = useSignal(page.runs.all);
  const others = all.filter((one) => one.id !== watch.id && isLive(one.phase));
  if (others.length === 0) return null;
  return (
    <label className="mission-switch">
      <span className="visually-hidden">Other active runs</span>
      <select value="" onChange={(event) => run("run.show", event.currentTarget.value)}>
        <option value="" disabled>
          {others.length === 1 ? "1 other run" : `${others.length} other runs`}
        </option>
        {others.map((one) => (
          <option key={one.id} value={one.id}>
            {one.name}, started {startedAt(one)}
          </option>
        ))}
      </select>
    </label>
  );
}
