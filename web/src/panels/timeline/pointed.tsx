/** Description of the hovered position on the timeline: state, time, duration and outcome. */

import { errorInWords } from "../../store/history/failures.ts";
import type { Journal } from "../../store/history/journal.ts";
import { type CallLook, hasFailed, lookOf } from "../../store/history/lanes.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime } from "../../store/page/times.ts";
import { useSignal } from "../../ui/signals.ts";
import { measured } from "../parts/duration.ts";
import { namesOf } from "../parts/happened.ts";
import type { Pointed as PointedPlace, TimelineModel } from "./model.ts";

interface PointedProps {
  readonly tab: OpenTab;
  readonly model: TimelineModel;
}

const WIDTH_PX = 240;

export function Pointed({ tab, model }: PointedProps) {
  const pointed = useSignal(model.pointed);
  if (!pointed || (pointed.call === null && pointed.seen === null)) return null;
  const { many, failed } = pointed;
  const isLeft = pointed.x < WIDTH_PX;
  const side = isLeft ? { left: pointed.x + 14 } : { left: pointed.x - WIDTH_PX - 6 };
  return (
    <div
      className="timeline-pointed"
      style={{ top: pointed.y + 14, width: WIDTH_PX, ...side }}
      aria-hidden
    >
      <strong>{namesOf(tab.session)(pathOf(model, pointed))}</strong>
      {many > 1 && (
        <span>
          and {many - 1} more here{failed > 0 ? `, ${failed} of them failed` : ""}: zoom in
        </span>
      )}
      {pointed.call === null ? (
        <SeenThere model={model} pointed={pointed} />
      ) : (
        <CallThere model={model} call={pointed.call} />
      )}
    </div>
  );
}

function pathOf({ calls }: TimelineModel, { call, seen }: PointedPlace): string {
  return call === null ? (seen?.path ?? "") : calls.path(call);
}

function CallThere({ model, call }: Pick<PointedProps, "model"> & { readonly call: number }) {
  const { calls, end_ns } = model;
  const began = calls.began_ns(call);
  const length = calls.ended_ns(call, end_ns) - began;
  return (
    <>
      <span>
        from {runTime(model.watch, began)} for {measured(length / 1e6)}
      </span>
      <span>{endInWords(lookOf(calls, call), calls.outcome(call)?.name ?? "")}</span>
      {hasFailed(calls, call) && (
        <span className="timeline-error">{errorAt(calls.journal, calls.end(call))}</span>
      )}
    </>
  );
}

/** Data from the server. For merged calls it contains only their time. */
function SeenThere({ model, pointed: { seen } }: Pick<PointedProps, "model"> & Here) {
  if (!seen) return null;
  const length = (seen.to_ns ?? model.end_ns) - seen.from_ns;
  return (
    <>
      <span>
        from {runTime(model.watch, seen.from_ns)} for {measured(length / 1e6)}
      </span>
      {seen.many === 1 && <span>{SEEN_ENDS[seen.look]}</span>}
    </>
  );
}

const SEEN_ENDS: Readonly<Record<CallLook, string>> = {
  open: "active",
  ended: "ended",
  aborted: "aborted, or ended with an error",
  preempted: "preempted",
  back: "undone by a step back",
  dropped: "interrupted: the run went back, or its program died",
};

interface Here {
  readonly pointed: PointedPlace;
}

const ERROR_MAX = 120;

function errorAt(journal: Journal, end: number): string {
  const words = errorInWords(journal.error(end)).replaceAll(/\s+/g, " ");
  if (words === "") return journal.hasError(end) ? "with an error" : "";
  return words.length > ERROR_MAX ? `${words.slice(0, ERROR_MAX - 1)}…` : words;
}

function endInWords(look: CallLook, outcome: string): string {
  switch (look) {
    case "open":
      return "active";
    case "back":
      return "undone by a step back";
    case "dropped":
      return "interrupted: the run went back, or its program died";
    default:
      return `ended with ${outcome}`;
  }
}
