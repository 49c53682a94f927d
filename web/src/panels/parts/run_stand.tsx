/** How a run stands: by colour, shape and word. */

import type { RunStand } from "../../model/run_words.ts";
import "./run_stand.css";

export function RunStandView({ stand }: { stand: RunStand }) {
  const { word, tone, detail } = stand;
  return (
    <span className={`run-stand run-tone-${tone}`} title={detail}>
      <span className={`run-dot run-dot-${tone}`} aria-hidden />
      <span className="run-word">{word}</span>
      {detail !== "" && <span className="run-detail">{detail}</span>}
    </span>
  );
}
