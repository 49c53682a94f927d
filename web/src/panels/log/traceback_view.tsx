/** Readable traceback: the exception, the line of the user's script, and all frames on request. */

import { Fragment } from "react";
import { readTraceback, type TracebackFrame } from "../../model/traceback.ts";
import { Button } from "../../ui/button.tsx";

interface TracebackViewProps {
  readonly text: string;
  /** Shows a line of the script. */
  readonly onLine: (line: number) => void;
}

/** Text that may end with a traceback. */
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
        // biome-ignore lint/suspicious/noArrayIndexKey: the order of causes is fixed
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
                // biome-ignore lint/suspicious/noArrayIndexKey: the order of frames is fixed
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

/** Line of the user's script. */
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
