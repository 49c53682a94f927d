/** A watched value: its source, the watched expression, the current value, and its history. */

import { ChevronLeft, ChevronRight, X } from "lucide-react";
import { useEffect, useMemo } from "react";
import { type Expression, readExpression } from "../../model/expression.ts";
import { namesTo } from "../../model/machine.ts";
import { previewValue } from "../../model/preview.ts";
import type { Watch } from "../../store/history/run.ts";
import type { ChangeOfValue } from "../../store/history/series.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime, runTimes, timeScale } from "../../store/page/times.ts";
import { ValueHistory } from "../../store/run/value_history.ts";
import {
  changeWatched,
  removeWatched,
  type WatchedExpression,
  WHOLE,
} from "../../store/run/watched_values.ts";
import { IconButton } from "../../ui/button.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { dataSize } from "../parts/data_size.ts";
import { OnRobotValue } from "../parts/value/on_robot.tsx";
import { useValue } from "../parts/value/use_value.ts";
import { ValueView } from "../parts/value/value_view.tsx";
import { reveal } from "../reveal.ts";
import { Ahead } from "./ahead.tsx";
import { Plot } from "./plot.tsx";
import type { ShownValue } from "./watched_value.ts";

interface WatchCardProps {
  readonly tab: OpenTab;
  readonly watched: WatchedExpression;
  readonly watch: Watch | null;
}

const KIND_WORDS = {
  input: "input of",
  output: "output of",
  scoped_variable: "in",
  global: "global variable",
} as const;

export function WatchCard({ tab, watched, watch }: WatchCardProps) {
  const { expression } = watched;
  const read = useMemo(() => readExpression(expression), [expression]);
  return (
    <article className="watches-card" aria-label={`${watched.target.name}: ${expression}`}>
      <Head tab={tab} watched={watched} />
      <TextField
        label={`Watched expression of ${watched.target.name}`}
        hideLabel
        mono
        value={expression}
        placeholder={WHOLE}
        check={refusalOf}
        onCommit={(text) => changeWatched(tab, watched.id, text.trim() || WHOLE)}
      />
      {watch && "of" in read && (
        <InRun tab={tab} watched={watched} watch={watch} expression={read} />
      )}
      {!watch && <p className="watches-faint">Its value appears once a run is shown.</p>}
    </article>
  );
}

function refusalOf(text: string): string | null {
  const read = readExpression(text.trim() || WHOLE);
  return "refused" in read ? read.refused : null;
}

function Head({ tab, watched }: Omit<WatchCardProps, "watch">) {
  const host = useHost();
  const { kind, path, name } = watched.target;
  const names = path === "" ? [] : namesTo(tab.session.machine, path);
  return (
    <div className="watches-head">
      <strong>{name}</strong>
      <span className="watches-faint">{KIND_WORDS[kind]}</span>
      {path !== "" && (
        <button
          type="button"
          className="watches-link"
          title={names.join(" / ")}
          onClick={() => reveal(host, { kind: "state", path })}
        >
          {names.at(-1)}
        </button>
      )}
      <IconButton
        className="watches-mini"
        label={`Stop watching ${name}`}
        icon={<X size={13} />}
        onClick={() => removeWatched(tab, watched.id)}
      />
    </div>
  );
}

interface WatchInRunProps {
  readonly tab: OpenTab;
  readonly watched: WatchedExpression;
  readonly watch: Watch;
  readonly expression: Expression;
}

function InRun({ tab, watched, watch, expression }: WatchInRunProps) {
  const { page } = useHost().context();
  const { target } = watched;
  const history = useMemo(
    () => new ValueHistory(page.runs, watch, target, expression),
    [page, watch, target, expression],
  );
  useEffect(() => history.follow(), [history]);
  const shown: ShownValue = useMemo(
    () => ({ name: target.name, watch, history }),
    [target, watch, history],
  );
  return (
    <div className="watches-run shows-run">
      <Now tab={tab} watched={watched} watch={watch} expression={expression} />
      <Over watched={shown} />
    </div>
  );
}

function Now({ tab, watched, watch, expression }: WatchInRunProps) {
  const { page } = useHost().context();
  const now = useValue(page, tab, watch, watched.target);
  if (now.state === "coming") return <p className="watches-faint">…</p>;
  if (now.state === "none") return <p className="watches-faint">No value: {now.why}.</p>;
  if (now.state === "long") {
    const { type_name, bytes } = now.long;
    return (
      <p className="watches-faint">
        A new {type_name || "value"} of {dataSize(bytes)}: it comes with its event.{" "}
        <Ahead watch={watch} at_ns={now.aheadAt_ns} />
      </p>
    );
  }
  const worked = expression.of(now.value);
  if ("refused" in worked) return <p className="watches-refusal">{worked.refused}</p>;
  const isOfRobot = (watch.now.peek()?.run.robot ?? null) !== null;
  return (
    <>
      <ValueView
        value={worked.value}
        keep={`watched ${watched.id} ${watched.expression}`}
        actions={
          now.aheadAt_ns !== undefined ? (
            <Ahead watch={watch} at_ns={now.aheadAt_ns} />
          ) : (
            now.sequence !== null && <Since watch={watch} sequence={now.sequence} />
          )
        }
      />
      {isOfRobot && now.aheadAt_ns === undefined && (
        <OnRobotValue
          page={page}
          watch={watch}
          sequence={now.sequence}
          name={watched.target.name}
        />
      )}
    </>
  );
}

/** Time at which the value was set. */
function Since({ watch, sequence }: { watch: Watch; sequence: number }) {
  useSignal(timeScale);
  const { journal } = watch;
  const t_ns = journal.t_ns(journal.indexOf(sequence));
  return (
    <span className="watches-when" title={runTimes(watch, t_ns)}>
      {runTime(watch, t_ns)}
    </span>
  );
}

/** History of the value: a plot for numbers, otherwise the last changes. */
function Over({ watched }: { watched: ShownValue }) {
  const { history, watch } = watched;
  useSignal(history.changed);
  const refusal = useSignal(history.refusal);
  const isLoaded = useSignal(history.isLoaded);
  const { points, changes } = history.series;
  return (
    <>
      {refusal !== null && <p className="watches-refusal">{refusal}</p>}
      {points.length > 0 && (
        <>
          <Plot watched={watched} />
          <Steps watched={watched} />
        </>
      )}
      {points.length === 0 && changes.length > 0 && <Changes changes={changes} watch={watch} />}
      {isLoaded && history.series.count === 0 && (
        <p className="watches-faint">No value yet in this run.</p>
      )}
    </>
  );
}

/** Buttons for the previous and next value. They do by keyboard what a click into the plot does. */
function Steps({ watched: { name, watch, history } }: { watched: ShownValue }) {
  const playhead = useSignal(watch.playhead);
  const { series } = history;
  const at = playhead ?? Number.POSITIVE_INFINITY;
  const [before, after] = [series.beside(at, "before"), series.beside(at, "after")];
  const show = (sequence: number | undefined) => {
    if (sequence !== undefined) watch.playhead.value = sequence;
  };
  return (
    <div className="watches-steps">
      <IconButton
        className="watches-mini"
        label={`Show the previous value of ${name}`}
        icon={<ChevronLeft size={14} />}
        disabled={!before}
        onClick={() => show(before?.sequence)}
      />
      <IconButton
        className="watches-mini"
        label={`Show the next value of ${name}`}
        icon={<ChevronRight size={14} />}
        disabled={!after}
        onClick={() => show(after?.sequence)}
      />
      <output className="watches-cursor-value" />
      <span className="watches-faint">{series.count} values</span>
    </div>
  );
}

/** Maximum number of displayed changes. */
const CHANGES_SHOWN = 20;
/** Maximum number of characters of a change. */
const CHANGE_MAX = 60;

function Changes({ changes, watch }: { changes: readonly ChangeOfValue[]; watch: Watch }) {
  const playhead = useSignal(watch.playhead);
  useSignal(timeScale);
  const here = changes.findLast(({ sequence }) => playhead !== null && sequence <= playhead);
  return (
    <ol className="watches-changes" aria-label="Last changes, newest first">
      {changes
        .slice(-CHANGES_SHOWN)
        .reverse()
        .map(({ sequence, t_ns, value }) => (
          <li
            key={sequence}
            aria-current={sequence === here?.sequence ? "true" : undefined}
            className={playhead !== null && sequence > playhead ? "watches-later" : undefined}
          >
            <button
              type="button"
              className="watches-link"
              onClick={() => {
                watch.playhead.value = sequence;
              }}
            >
              {runTime(watch, t_ns)}
            </button>
            <code>{previewValue(value, CHANGE_MAX)}</code>
          </li>
        ))}
    </ol>
  );
}
