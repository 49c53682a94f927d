/** How a run stands, by a picture, a colour and a word. */

import {
  Ban,
  CircleCheck,
  CirclePause,
  CirclePlay,
  CircleStop,
  CircleX,
  Footprints,
  Hourglass,
  Loader,
  type LucideIcon,
  TriangleAlert,
} from "lucide-react";
import type { RunStand, RunWord } from "../../model/run_words.ts";

const SIGNS: Readonly<Record<RunWord, LucideIcon>> = {
  starting: Loader,
  running: CirclePlay,
  waiting: Hourglass,
  paused: CirclePause,
  stepping: Footprints,
  stopping: CircleStop,
  finished: CircleCheck,
  crashed: TriangleAlert,
  "not started": Ban,
  unreadable: CircleX,
};

export function StatusWord({
  stand,
  size = 16,
}: {
  readonly stand: RunStand;
  readonly size?: number;
}) {
  const isBad = stand.word === "finished" && stand.tone !== "plain";
  const Sign = isBad ? CircleX : SIGNS[stand.word];
  return (
    <span className={`mission-word mission-tone-${stand.tone}`}>
      <Sign size={size} aria-hidden />
      <span>{stand.word}</span>
      {stand.word === "finished" && stand.detail && (
        <span className="mission-status-outcome">{stand.detail}</span>
      )}
    </span>
  );
}
