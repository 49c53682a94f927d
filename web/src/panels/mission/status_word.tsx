/** Status of a run, as icon, colour and text. */

import {
  Ban,
  CircleCheck,
  CirclePause,
  CirclePlay,
  CircleStop,
  CircleX,
  Footprints,
  GitCompareArrows,
  Hourglass,
  Loader,
  type LucideIcon,
  TriangleAlert,
} from "lucide-react";
import type { RunStatusWords, RunWord } from "../../model/run_words.ts";

const SIGNS: Readonly<Record<RunWord, LucideIcon>> = {
  starting: Loader,
  running: CirclePlay,
  waiting: Hourglass,
  paused: CirclePause,
  stepping: Footprints,
  stopping: CircleStop,
  finished: CircleCheck,
  crashed: TriangleAlert,
  diverged: GitCompareArrows,
  "not started": Ban,
  unreadable: CircleX,
};

export function StatusWord({
  status,
  size = 16,
  assumed = null,
}: {
  readonly status: RunStatusWords;
  readonly size?: number;
  /** Age of the status if it is assumed; null if it is current. */
  readonly assumed?: string | null;
}) {
  const isBad = status.word === "finished" && status.tone !== "plain";
  const Icon = isBad ? CircleX : SIGNS[status.word];
  return (
    <span
      className={`mission-word mission-tone-${status.tone} ${assumed === null ? "" : "mission-assumed shows-run"}`}
    >
      <Icon size={size} aria-hidden />
      <span>{status.word}</span>
      {status.word === "finished" && status.detail && (
        <span className="mission-status-outcome">{status.detail}</span>
      )}
      {assumed !== null && <small>{assumed}</small>}
    </span>
  );
}
