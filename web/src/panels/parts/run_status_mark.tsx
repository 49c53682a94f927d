/** Status of a run, as colour, shape and text. */

import type { RunStatusWords } from "../../model/run_words.ts";
import "./run_status_mark.css";

interface RunStatusProps {
  readonly status: RunStatusWords;
  /** Age of the status if it is assumed; null if it is current. */
  readonly assumed?: string | null;
}

export function RunStatusView({ status, assumed = null }: RunStatusProps) {
  const { word, tone, detail } = status;
  return (
    <span
      className={`run-status run-tone-${tone} ${assumed === null ? "" : "run-assumed"}`}
      title={detail}
    >
      <span className={`run-dot run-dot-${tone}`} aria-hidden />
      <span className="run-word">{word}</span>
      {detail !== "" && <span className="run-detail">{detail}</span>}
      {assumed !== null && <span className="run-detail">{assumed}</span>}
    </span>
  );
}
