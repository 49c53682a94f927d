/** What the pointer is at on the time line: which state, when, how long, how it ended. */

import { errorInWords } from "../../store/history/failures.ts";
import type { Journal } from "../../store/history/journal.ts";
import { type CallLook, hasFailed, lookOf } from "../../store/history/lanes.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime } from "../../store/page/times.ts";
import { useSignal } from "../../ui/signals.ts";
import { measured } from "../parts/duration.ts";
import { namesOf } from "../parts/happened.ts";
import type { TimelineModel } from "./model.ts";

interface PointedProps {
  readonly tab: OpenTab;
  readonly model: TimelineModel;
}

const WIDTH_PX = 240;

export function Pointed({ tab, model }: PointedProps) {
  const pointed = useSignal(model.pointed);
  if (!pointed || pointed.call === null) return null;
  const { calls, end_ns } = model;
  const { call, many, failed } = pointed;
  const isLeft = pointed.x < WIDTH_PX;
  const side = isLeft ? { left: pointed.x + 14 } : { left: pointed.x - WIDTH_PX - 6 };
  const began = calls.began_ns(call);
  const length = calls.ended_ns(call, end_ns) - began;
  return (
    <div
      className="timeline-pointed"
      style={{ top: pointed.y + 14, width: WIDTH_PX, ...side }}
      aria-hidden
    >
      <strong>{namesOf(tab.session)(calls.path(call))}</strong>
      {many > 1 && (
        <span>
          and {many - 1} more here{failed > 0 ? `, ${failed} of them failed` : ""}: zoom in
        </span>
      )}
      <span>
        from {runTime(model.watch, began)} for {measured(length / 1e6)}
      </span>
      <span>{endInWords(lookOf(calls, call), calls.outcome(call)?.name ?? "")}</span>
      {hasFailed(calls, call) && (
        <span className="timeline-error">{errorAt(calls.journal, calls.end(call))}</span>
      )}
    </div>
  );
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
