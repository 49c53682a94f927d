/** Selected line of the log in full, with links to its state, its moment, and a line of a script. */

import { Clock, Copy, X } from "lucide-react";
import type { Watch } from "../../store/history/run.ts";
import { runTimes, wallTime } from "../../store/page/times.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { useHost } from "../context.tsx";
import type { LogEntry } from "./entries.ts";
import { TracebackView } from "./traceback_view.tsx";

interface ChosenLineProps {
  readonly entry: LogEntry;
  readonly watch: Watch | null;
  readonly stateName: string;
  /** Null if the page shows no run. */
  readonly onMoment: (() => void) | null;
  readonly onState: () => void;
  readonly onLine: (line: number) => void;
  readonly onClose: () => void;
}

export function ChosenLine({
  entry,
  watch,
  stateName,
  onMoment,
  onState,
  onLine,
  onClose,
}: ChosenLineProps) {
  const { commands, context } = useHost();
  const { text, action, line, at_ms, level } = entry;
  return (
    <section className="log-full" aria-label="Selected line">
      <div className="log-about">
        <span className={`log-${level}`}>{level}</span>
        <span className="log-time">
          {line && watch
            ? runTimes(watch, line.t_ns).replaceAll("\n", ", ")
            : wallTime(at_ms, Date.now())}
        </span>
        {line && line.path !== "" && (
          <Button kind="quiet" title="Show the state" onClick={onState}>
            {stateName}
          </Button>
        )}
        <span className="log-gap" />
        {line && onMoment && (
          <Button icon={<Clock size={14} />} onClick={onMoment}>
            Show this moment
          </Button>
        )}
        <Button
          icon={<Copy size={14} />}
          title="Copy the text"
          onClick={() => void navigator.clipboard.writeText(text)}
        >
          Copy
        </Button>
        {action && (
          <Button onClick={() => void commands.call(action, context())}>{action.title}</Button>
        )}
        <IconButton label="Close selected line" icon={<X size={15} />} onClick={onClose} />
      </div>
      <TracebackView key={entry.id} text={text} onLine={onLine} />
    </section>
  );
}
