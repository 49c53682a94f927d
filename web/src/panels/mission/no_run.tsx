/** Mission control without a run: a choice of active runs, and the start of a new one. */

import { Radar } from "lucide-react";
import { isLive, summaryStatusWords } from "../../model/run_words.ts";
import { startedAt, timeScale } from "../../store/page/times.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useCommand, useHost } from "../context.tsx";
import { useAssumed } from "../parts/assumed.ts";
import { duration, growing } from "../parts/duration.ts";
import { Identity } from "./identity.tsx";
import { StatusWord } from "./status_word.tsx";

/** Maximum number of finished runs in the list. The newest are shown. */
const OVER_MAX = 5;

export function NoRun() {
  const { context, commands } = useHost();
  const { page } = context();
  const run = useCommand();
  const all = useSignal(page.runs.all);
  const coming = useSignal(page.comingRun);
  const robots = useSignal(page.robots);
  const live = all.filter(({ phase }) => isLive(phase));
  const over = all.filter(({ phase }) => !isLive(phase)).slice(0, OVER_MAX);
  const refusal = useComputed(() => {
    page.active.value;
    return commands.refusalOf("run.start", context());
  }, [page, commands, context]);
  if (coming !== null) {
    const name = all.find(({ id }) => id === coming)?.name ?? coming;
    return (
      <div className="mission-none" role="status">
        <Radar size={40} aria-hidden />
        <h2>{name}</h2>
        <p>Loading the run…</p>
      </div>
    );
  }
  return (
    <div className="mission-none">
      <Radar size={40} aria-hidden />
      <h2>{live.length === 0 ? "No mission is running" : "Which mission?"}</h2>
      <p>
        {live.length === 0
          ? "Open a machine and start it. What the robot does, asks and reports is shown here."
          : "Choose a run to see what the robot does, and to steer it."}
      </p>
      {live.length > 0 && <RunList label="Active runs" runs={live} />}
      <Button
        kind={live.length === 0 ? "primary" : "plain"}
        disabled={refusal !== null}
        title={refusal === null ? "Start the open machine" : `Start: ${refusal}`}
        onClick={() => run("run.start")}
      >
        Start the open machine
      </Button>
      {robots.length > 0 && (
        <Button onClick={() => run("run.start-at-robot")}>Start a machine of a robot…</Button>
      )}
      {refusal && <p className="mission-why">Start: {refusal}.</p>}
      {over.length > 0 && (
        <>
          <h3>Finished</h3>
          <RunList label="Finished runs" runs={over} />
        </>
      )}
      <Identity />
    </div>
  );
}

function RunList({ label, runs }: { readonly label: string; readonly runs: readonly RunInList[] }) {
  const run = useCommand();
  useSignal(timeScale);
  return (
    <ul className="mission-runs" aria-label={label}>
      {runs.map((one) => (
        <li key={one.id}>
          <button type="button" onClick={() => run("run.show", one.id)}>
            <span className="mission-run-name">{one.name}</span>
            <StatusLine run={one} />
            <small>
              started {startedAt(one)}
              {one.author ? ` by ${one.author}` : ""}, <Length run={one} />
            </small>
          </button>
        </li>
      ))}
    </ul>
  );
}

function StatusLine({ run }: { readonly run: RunInList }) {
  const assumed = useAssumed(run);
  return (
    <span className={assumed === null ? "" : "is-old"}>
      <StatusWord status={summaryStatusWords(run)} assumed={assumed} />
    </span>
  );
}

/** Length of a run. An active run grows until its last confirmation. */
function Length({ run }: { readonly run: RunInList }) {
  const { page } = useHost().context();
  const text = useComputed(() => {
    if (!isLive(run.phase)) return duration(run.length_ms);
    const server_ms = page.server.pulse.value?.server_ms ?? 0;
    const there_ms = Math.min(run.unheard_since_ms ?? server_ms, server_ms);
    return growing(Math.max(0, there_ms - run.started_ms));
  }, [page, run]);
  return <>{text}</>;
}

type RunInList = Parameters<typeof summaryStatusWords>[0];
