/** Status of the state in the shown run, live or at the shown moment. */

import { computed } from "@preact/signals-core";
import { useEffect, useMemo } from "react";
import type { Phase } from "../../model/generated/protocol.ts";
import { ABORTED } from "../../model/machine.ts";
import { holdInWords } from "../../model/run_words.ts";
import type { Watch } from "../../store/history/run.ts";
import { pictureOf, type StateStatus, stateStatusOf } from "../../store/run/state_status.ts";
import { useSignal } from "../../ui/signals.ts";
import { useThrottled } from "../../ui/throttled.ts";
import { AsOf } from "../parts/as_of.tsx";
import { growing, measured } from "../parts/duration.ts";
import { useDetail } from "../parts/value/use_detail.ts";
import { useSinceSnapshot } from "../since_snapshot.ts";
import { Fold } from "./fold.tsx";
import { RunError } from "./in_run_error.tsx";
import { GlobalValues, RunValues } from "./in_run_values.tsx";
import type { InspectedState } from "./inspector_context.ts";
import "./in_run.css";

/** Refresh interval of changing numbers, in ms. */
const PACE_MS = 200;

const PHASE_WORDS: Readonly<Record<Phase, string>> = {
  running: "runs",
  waiting: "waits",
  interrupted: "interrupted by a crash",
  held: "paused",
  preempted: "being preempted",
};

export function InRun({ inspected }: { inspected: InspectedState }) {
  const watch = useSignal(inspected.tab.run);
  if (!watch) return null;
  return (
    <Fold title="In the run">
      <div className="shows-run">
        <OfRun key={`${watch.id} ${inspected.path}`} inspected={inspected} watch={watch} />
      </div>
    </Fold>
  );
}

/** Global variables at the shown moment. */
export function GlobalsInRun({ inspected }: { inspected: InspectedState }) {
  const watch = useSignal(inspected.tab.run);
  return watch && <Globals inspected={inspected} watch={watch} />;
}

function Globals({ inspected, watch }: { inspected: InspectedState; watch: Watch }) {
  useEffect(() => watch.wantValues(), [watch]);
  const signal = useMemo(() => computed(() => pictureOf(watch)?.globals ?? null), [watch]);
  const globals = useThrottled(signal, PACE_MS);
  const count = Object.keys(globals ?? {}).length;
  if (!globals || count === 0) return null;
  return (
    <Fold title="Global variables in the run" count={count}>
      <div className="shows-run">
        <GlobalValues inspected={inspected} watch={watch} values={globals} />
      </div>
    </Fold>
  );
}

function OfRun({ inspected, watch }: { inspected: InspectedState; watch: Watch }) {
  const { path } = inspected;
  useEffect(() => watch.wantValues(), [watch]);
  const signal = useMemo(() => computed(() => stateStatusOf(watch, path)), [watch, path]);
  const status = useThrottled(signal, PACE_MS);
  const isCaughtUp = useSignal(watch.isCaughtUp);
  const { entered, left } = status;
  const { runs } = inspected.page;
  const entry = useDetail(runs, watch.id, wanted(entered?.sequence, status.inputs));
  const isAborted = left?.outcome?.id === ABORTED;
  const end = useDetail(runs, watch.id, wanted(left?.sequence, status.outputs, isAborted));
  if (!entered && !status.active) {
    return <p className="inspector-none">{neverInWords(status, isCaughtUp)}</p>;
  }
  return (
    <div className="shows-run">
      <Facts watch={watch} status={status} />
      {left && <RunError inspected={inspected} watch={watch} left={left} detail={end.detail} />}
      <RunValues inspected={inspected} watch={watch} status={status} entry={entry} end={end} />
    </div>
  );
}

function neverInWords({ next, until }: StateStatus, isCaughtUp: boolean): string {
  if (next) return `It runs next, ${holdInWords(next)}.`;
  if (!isCaughtUp) return "The history of the run is not here yet.";
  return until === null ? "It has not run yet in this run." : "It had not run yet at this moment.";
}

/** Event to request; null if its values are available. */
function wanted(sequence: number | undefined, values: unknown, always = false): number | null {
  return sequence === undefined || (values !== undefined && !always) ? null : sequence;
}

interface FactsProps {
  readonly watch: Watch;
  readonly status: StateStatus;
}

function Facts({ watch, status }: FactsProps) {
  const { active, visits, left, entered, next } = status;
  return (
    <dl className="in-run-facts">
      <dt>Phase</dt>
      <dd className={active ? `in-run-${active.phase}` : next ? "in-run-next" : "inspector-faint"}>
        {active ? PHASE_WORDS[active.phase] : next ? "comes next" : "not active"}
        {!active && next ? `, ${holdInWords(next)}` : ""}
        {active?.detail ? ` for ${active.detail}` : ""}
      </dd>
      {active ? <Since watch={watch} status={status} /> : null}
      {!active && entered && left && left.sequence > entered.sequence ? (
        <>
          <dt>Took</dt>
          <dd>{measured((left.t_ns - entered.t_ns) / 1e6)} the last time</dd>
        </>
      ) : null}
      <dt>Visits</dt>
      <dd>{visits.toLocaleString("en")}</dd>
      {left?.outcome ? (
        <>
          <dt>Last outcome</dt>
          <dd className={left.outcome.id === ABORTED ? "in-run-failed" : undefined}>
            {left.outcome.name}
          </dd>
        </>
      ) : null}
    </dl>
  );
}

/** Time since the state became active. It grows between snapshots while the run is received. */
function Since({ watch, status }: FactsProps) {
  const sinceSnapshot_ms = useSinceSnapshot(watch);
  const isLive = useSignal(watch.playhead) === null;
  return (
    <>
      <dt>Since</dt>
      <dd>
        {growing((status.active?.since_ms ?? 0) + sinceSnapshot_ms)}
        {isLive && <AsOf watch={watch} />}
      </dd>
    </>
  );
}
