/** A traceback for people: what was raised, the line of one's own script, and behind a click all the frames. */

import { Fragment } from "react";
import { readTraceback, type TracebackFrame } from "../../model/traceback.ts";
import { Button } from "../../ui/button.tsx";

interface TracebackViewProps {
  readonly text: string;
  /** Leads to a line of the script. */
  readonly onLine: (line: number) => void;
}

/** A text that may have a traceback at its end. */
export function TracebackView({ text, onLine }: TracebackViewProps) {
  const traceback = readTraceback(text);
  if (!traceback) return <pre className="log-text">{text}</pre>;
  const { frames, own, message, causes } = traceback;
  const before = text.slice(0, text.indexOf("Traceback (most recent call last)")).trimEnd();
  return (
    <>
      {before !== "" && <pre className="log-text">{before}</pre>}
      <pre className="log-text log-raised">{message}</pre>
      {own && <Own frame={own} onLine={onLine} />}
      {causes.map((cause, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: causes stay where they are
        <Fragment key={index}>
          <p className="log-cause">caused by</p>
          <pre className="log-text log-raised">{cause.message}</pre>
          {cause.own && <Own frame={cause.own} onLine={onLine} />}
        </Fragment>
      ))}
      {frames.length > 0 && (
        <details className="log-frames">
          <summary>
            {frames.length === 1 ? "Full traceback" : `All ${frames.length} frames`}
          </summary>
          <ol>
            {frames.map((frame, index) => (
              <FrameView
                // biome-ignore lint/suspicious/noArrayIndexKey: frames stay where they are
                key={index}
                frame={frame}
                isOwn={frame.file === own?.file}
                onLine={onLine}
              />
            ))}
          </ol>
        </details>
      )}
    </>
  );
}

/** The line of one's own script. */
function Own({
  frame,
  onLine,
}: { readonly frame: TracebackFrame } & Pick<TracebackViewProps, "onLine">) {
  const { line, function: name, code } = frame;
  return (
    <p className="log-own">
      <Button kind="quiet" onClick={() => onLine(line)} title="Show this line of the script">
        script.py line {line}
      </Button>
      in {name}
      {code !== "" && <code>{code}</code>}
    </p>
  );
}

interface FrameProps {
  readonly frame: TracebackFrame;
  readonly isOwn: boolean;
  readonly onLine: (line: number) => void;
}

function FrameView({ frame: { file, line, function: name, code }, isOwn, onLine }: FrameProps) {
  const isEngine = file.startsWith("<");
  return (
    <li className={isEngine ? "log-frame-engine" : undefined}>
      {isOwn ? (
        <button type="button" className="log-link" onClick={() => onLine(line)}>
          {file}, line {line}
        </button>
      ) : (
        <span>
          {file}, line {line}
        </span>
      )}
      , in {name}
      {code !== "" && <code>{code}</code>}
    </li>
  );
}
