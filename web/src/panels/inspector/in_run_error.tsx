/** Error of the last end of a state: its message, and a link to its line in the script. */

import { useMemo, useState } from "react";
import type { EventDetail } from "../../model/generated/protocol.ts";
import { ABORTED } from "../../model/machine.ts";
import { shortValue } from "../../model/short_value.ts";
import { type EndReason, endReasonAt } from "../../store/history/end_reason.ts";
import type { Watch } from "../../store/history/run.ts";
import { failureAt, type ScriptFailure } from "../../store/history/script_failure.ts";
import { visitsOf } from "../../store/history/visits.ts";
import { scriptLineRevealRequest } from "../../store/page/reveal_requests.ts";
import type { VisitEnd } from "../../store/run/state_status.ts";
import { Button } from "../../ui/button.tsx";
import type { InspectedState } from "./inspector_context.ts";

interface RunErrorProps {
  readonly inspected: InspectedState;
  readonly watch: Watch;
  readonly left: VisitEnd;
  /** End with its values; null until it is loaded. */
  readonly detail: EventDetail | null;
}

const MESSAGE_MAX = 1_000;

export function RunError({ inspected, watch, left, detail }: RunErrorProps) {
  const { path } = inspected;
  const failure = useMemo(() => failureOf(watch, path, left.sequence), [watch, path, left]);
  const event = detail?.sequence === left.sequence ? detail.event : null;
  const error = event?.type === "left" ? event.error : null;
  if (error == null && left.outcome?.id !== ABORTED) return null;
  if (error == null && !failure) return <Reason inspected={inspected} watch={watch} left={left} />;
  const message = error == null ? failure?.traceback.message : shortValue(error, MESSAGE_MAX);
  return (
    <div className="in-run-error" role="note" aria-label="Error">
      <p>
        <strong>Ended with an error</strong>
        {message ? `: ${message}` : ""}
      </p>
      {failure && <Place inspected={inspected} failure={failure} />}
    </div>
  );
}

type ReasonProps = Omit<RunErrorProps, "detail">;

/** Reason of an end that has no error of its own. */
function Reason({ inspected, watch, left }: ReasonProps) {
  const { path, machine } = inspected;
  const reason = useMemo(() => reasonOf(watch, path, left.sequence), [watch, path, left]);
  const isInner = reason !== null && reason.path !== path;
  const name = isInner ? (machine.state(reason.path)?.name ?? "a state inside") : "";
  return (
    <div className="in-run-error" role="note" aria-label="Error">
      <p>
        <strong>Ended with {left.outcome?.name ?? "aborted"}</strong>:{" "}
        {isInner && (
          <>
            <button
              type="button"
              className="inspector-link"
              onClick={() => inspected.show({ kind: "state", path: reason.path })}
            >
              {name}
            </button>
            {": "}
          </>
        )}
        {reason?.text ?? chosenInWords(inspected)}
      </p>
    </div>
  );
}

/** Text for an outcome that was intended, without a failure. */
function chosenInWords({ state }: InspectedState): string {
  return state.kind === "execution"
    ? "its script returned this outcome and reported no error"
    : "a transition inside leads to this outcome, and no error was reported";
}

function reasonOf(watch: Watch, path: string, left: number): EndReason | null {
  const visits = visitsOf(watch);
  const entered = visits.lastIndex("entered", path, left) ?? 0;
  const end = visits.lastIndex("left", path, left);
  return end === null ? null : endReasonAt(watch.window, path, entered, end);
}

function failureOf(watch: Watch, path: string, left: number): ScriptFailure | null {
  const visits = visitsOf(watch);
  const entered = visits.lastIndex("entered", path, left) ?? 0;
  const end = visits.lastIndex("left", path, left);
  return end === null ? null : failureAt(watch.window, path, entered, end);
}

/** Shows the frame of the script first, and the others on request. */
function Place({
  inspected,
  failure: { traceback, text, path },
}: {
  inspected: InspectedState;
  failure: ScriptFailure;
}) {
  const [isWhole, setWhole] = useState(false);
  const { own, frames } = traceback;
  const name = inspected.machine.state(path)?.name ?? path;
  const show = () => {
    if (!own) return;
    inspected.show({ kind: "state", path });
    scriptLineRevealRequest.value = { path, line: own.line };
  };
  return (
    <>
      {own && (
        <div className="in-run-frame">
          <button type="button" className="inspector-link" onClick={show}>
            {name}, line {own.line}
          </button>{" "}
          <span className="inspector-faint">in {own.function}</span>
          {own.code !== "" && <code>{own.code}</code>}
        </div>
      )}
      {traceback.causes.map(({ message }) => (
        <p key={message} className="in-run-cause">
          caused by {message}
        </p>
      ))}
      <Button kind="quiet" pressed={isWhole} onClick={() => setWhole(!isWhole)}>
        {isWhole ? "Hide traceback" : `Full traceback (${framesInWords(frames.length)})`}
      </Button>
      {isWhole && <pre className="in-run-traceback">{text}</pre>}
    </>
  );
}

function framesInWords(count: number): string {
  return count === 1 ? "1 frame" : `${count} frames`;
}
