/** How a run stands: by colour, shape and word. */

import type { RunStatusWords } from "../../model/run_words.ts";
import "./run_status_mark.css";

export function RunStatusView({ status }: { status: RunStatusWords }) {
  const { word, tone, detail } = status;
  return (
    <span className={`run-stand run-tone-${tone}`} title={detail}>
      <span className={`run-dot run-dot-${tone}`} aria-hidden />
      <span className="run-word">{word}</span>
      {detail !== "" && <span className="run-detail">{detail}</span>}
    </span>
  );
}
