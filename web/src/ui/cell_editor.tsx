/** The text of one cell while it is edited: Enter and leaving commit, Escape gives it up, a refusal keeps what was typed. */

import { useId, useRef, useState } from "react";
import { createPortal } from "react-dom";
import { type Commit, committed } from "./field.tsx";
import { isOthers, meanwhileInWords } from "./meanwhile.ts";

export type CellStep = -1 | 0 | 1;

interface CellEditorProps {
  readonly label: string;
  readonly value: string;
  readonly mono?: boolean | undefined;
  readonly suggestions?: readonly string[] | undefined;
  readonly check: (text: string) => string | null;
  readonly onCommit: (text: string) => Commit;
  /** It is over; after Tab the next cell is to be edited, after Shift+Tab the one before. */
  readonly onStop: (step: CellStep) => void;
}

export function CellEditor({ label, value, check, onCommit, onStop, ...rest }: CellEditorProps) {
  const [text, setText] = useState(value);
  const [refusal, setRefusal] = useState<string | null>(null);
  const over = useRef(false);
  const own = useRef<Set<string>>(new Set([value]));
  const input = useRef<HTMLInputElement>(null);
  const id = useId();
  const stop = (step: CellStep = 0) => {
    over.current = true;
    onStop(step);
  };
  const isBehind = isOthers(value, own.current, text);
  const commit = async (step: CellStep = 0) => {
    if (over.current) return;
    if (text === value) return stop(step);
    own.current.add(text);
    const answer = check(text) ?? onCommit(text);
    // Users who move to another cell are typing there already. Only an immediate refusal or a question keeps the focus here.
    if (step !== 0 && answer instanceof Promise) return stop(step);
    const fault = typeof answer === "string" ? answer : await committed(answer);
    if (fault == null) stop(step);
    else setRefusal(fault);
  };
  const message = refusal ?? (isBehind ? meanwhileInWords(value) : null);
  return (
    <>
      <input
        ref={input}
        className={`table-edit ${rest.mono ? "field-mono" : ""}`}
        aria-label={label}
        aria-invalid={message !== null}
        aria-describedby={message === null ? undefined : `${id}-refusal`}
        // biome-ignore lint/a11y/noAutofocus: the user asked to edit this cell
        autoFocus
        autoComplete="off"
        spellCheck={false}
        list={rest.suggestions ? `${id}-list` : undefined}
        value={text}
        onFocus={(event) => event.currentTarget.select()}
        onChange={(event) => {
          setText(event.currentTarget.value);
          setRefusal(null);
        }}
        onBlur={() => (isBehind ? stop() : void commit())}
        onKeyDown={(event) => {
          event.stopPropagation();
          if (event.key === "Escape") stop();
          if (event.key !== "Enter" && event.key !== "Tab") return;
          // The key that committed must not press the element that is focused next.
          event.preventDefault();
          void commit(event.key === "Enter" ? 0 : event.shiftKey ? -1 : 1);
        }}
      />
      {rest.suggestions && (
        <datalist id={`${id}-list`}>
          {rest.suggestions.map((one) => (
            <option key={one} value={one} />
          ))}
        </datalist>
      )}
      {message !== null && input.current && (
        <CellMessage id={`${id}-refusal`} at={input.current} text={message} />
      )}
    </>
  );
}

interface CellMessageProps {
  readonly id: string;
  readonly at: HTMLElement;
  readonly text: string;
}

const GAP_PX = 3;

/** Shown below the cell as an overlay, because a table of two rows has no room for it. */
function CellMessage({ id, at, text }: CellMessageProps) {
  const { left, bottom } = at.getBoundingClientRect();
  const host = at.closest("dialog") ?? at.ownerDocument.body;
  return createPortal(
    <div
      id={id}
      className="table-refusal"
      role="alert"
      style={{ left, top: bottom + GAP_PX, maxWidth: `calc(100vw - ${left + GAP_PX}px)` }}
    >
      {text}
    </div>,
    host,
  );
}
