/** Failures, the newest first, each until a user acknowledges it. */

import { CheckCheck, CircleX, type LucideIcon, TriangleAlert, Zap } from "lucide-react";
import { useEffect, useState } from "react";
import type { EventDetail } from "../../model/generated/protocol.ts";
import { shortValue } from "../../model/short_value.ts";
import { didInWords, FAILURES_MAX, type RunFailure } from "../../store/history/failures.ts";
import type { Watch } from "../../store/history/run.ts";
import { RefusalError } from "../../store/page/server.ts";
import {
  acknowledged,
  droppedFailures,
  failures,
  openFailures,
} from "../../store/run/acknowledged.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useStableFor } from "../../ui/stable_for.ts";
import { useCommand, useHost } from "../context.tsx";
import { growing } from "../parts/duration.ts";
import { reveal } from "../reveal.ts";
import { type Names, pathInWords, useMachineNames } from "./names.ts";
import { useWhen } from "./when.ts";

/** Maximum number of displayed events. */
const SHOWN_MAX = 30;

export function Events({ watch }: { readonly watch: Watch }) {
  const run = useCommand();
  const open = useSignal(openFailures(watch));
  const all = useSignal(failures(watch));
  const done = useSignal(acknowledged(watch));
  const dropped = useSignal(droppedFailures(watch));
  const names = useMachineNames();
  const [showsDone, setShowsDone] = useState(false);
  const shown = showsDone ? all : open;
  const unlisted = showsDone ? dropped.all : dropped.open;
  // Acknowledged lines of the user make room for the next ones.
  const newest = shown.slice(-SHOWN_MAX).reverse();
  // A line with a growing count keeps its position. Only a new line could move another one under the pointer.
  const isUnmoved = useStableFor(String(all.at(-1)?.first));
  return (
    <section className="mission-part mission-events" aria-label="Events to acknowledge">
      <div className="mission-part-head">
        <h3>
          {open.length === 0
            ? "Nothing to acknowledge"
            : `To acknowledge: ${countInWords(open.length)}`}
        </h3>
        {all.length > open.length && (
          <Button pressed={showsDone} onClick={() => setShowsDone(!showsDone)}>
            All {countInWords(all.length)}
          </Button>
        )}
        {open.length > 1 && (
          <Button
            icon={<CheckCheck size={16} aria-hidden />}
            onClick={() => run("mission.acknowledge")}
          >
            Acknowledge all
          </Button>
        )}
      </div>
      {all.length === 0 && (
        <p className="mission-soft">
          Failures, warnings and missed deadlines of this run appear here until you acknowledge
          them.
        </p>
      )}
      <ul className="mission-event-list">
        {newest.map((failure) => (
          <Line
            key={failure.first}
            failure={failure}
            watch={watch}
            names={names}
            isDone={done.has(failure.sequence)}
            isUnmoved={isUnmoved}
          />
        ))}
      </ul>
      {shown.length > SHOWN_MAX && (
        <p className="mission-soft">and {shown.length - SHOWN_MAX} older events</p>
      )}
      {unlisted > 0 && <p className="mission-soft">{unlistedInWords(unlisted, showsDone)}</p>}
    </section>
  );
}

/** Number of events. Above the capacity of the list it is a lower bound. */
export function countInWords(count: number): string {
  return count < FAILURES_MAX ? String(count) : `${FAILURES_MAX} or more`;
}

function unlistedInWords(count: number, withDone: boolean): string {
  const events = `${count} older ${count === 1 ? "event" : "events"}`;
  const left = `${count === 1 ? "is" : "are"} no longer listed here`;
  return `${events}${withDone ? "" : " that nobody acknowledged"} ${left}; the history has them.`;
}

interface EventLineProps {
  readonly failure: RunFailure;
  readonly watch: Watch;
  readonly names: Names;
  readonly isDone: boolean;
  readonly isUnmoved: boolean;
}

const SIGNS: Readonly<Record<RunFailure["level"], LucideIcon>> = {
  warning: TriangleAlert,
  error: CircleX,
};

function Line({ failure, watch, names, isDone, isUnmoved }: EventLineProps) {
  const host = useHost();
  const run = useCommand();
  const { level, kind, path, reach, count, t_ns, sequence } = failure;
  const Icon = kind === "crash" ? Zap : SIGNS[level];
  const around = path === "" ? [] : pathInWords(names, path).split(" › ");
  const where = around.pop() ?? "";
  const when = useWhen(watch, t_ns / 1e6);
  return (
    <li className={`mission-event mission-event-${level} ${isDone ? "mission-event-done" : ""}`}>
      <Icon size={18} aria-label={level} />
      <div className="mission-event-text">
        <p className="mission-event-head">
          {where !== "" && (
            <button
              type="button"
              className="mission-event-where"
              title="Show it on the canvas"
              onClick={() => reveal(host, { kind: "state", path })}
            >
              {where}
            </button>
          )}
          {didInWords(kind)}
          {count > 1 && <span className="mission-count">×{count}</span>}
          <time title={`${growing(t_ns / 1e6)} after the start`}>{when}</time>
        </p>
        {failure.text === "" ? (
          <ErrorText watch={watch} sequence={sequence} />
        ) : (
          <p className="mission-event-detail">{failure.text}</p>
        )}
        {around.length > 0 && <p className="mission-soft">in {around.join(" › ")}</p>}
        {reach !== path && (
          <p className="mission-soft">and all states up to {pathInWords(names, reach)}</p>
        )}
      </div>
      {isDone ? (
        <span className="mission-soft">acknowledged</span>
      ) : (
        <Button disabled={!isUnmoved} onClick={() => run("mission.acknowledge", sequence)}>
          Acknowledge
        </Button>
      )}
    </li>
  );
}

/** Error of an aborted state, for events whose log line does not contain it. */
function ErrorText({ watch, sequence }: { readonly watch: Watch; readonly sequence: number }) {
  const { page } = useHost().context();
  const isUp = useComputed(() => page.server.link.value.state === "up", [page]);
  const [text, setText] = useState<string | null>(null);
  useEffect(() => {
    if (!isUp || text !== null) return;
    let isGone = false;
    page.runs
      .get<EventDetail>(watch.id, `events/${sequence}`)
      .then((detail) => isGone || setText(errorIn(detail)))
      .catch((error: unknown) => {
        if (!(error instanceof RefusalError)) throw error;
      });
    return () => {
      isGone = true;
    };
  }, [page, watch, sequence, isUp, text]);
  return text ? <p className="mission-event-detail">{text}</p> : null;
}

function errorIn({ event }: EventDetail): string {
  const error = event.type === "left" ? (event.error ?? null) : null;
  return error === null ? "" : shortValue(error);
}
