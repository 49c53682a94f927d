/** Description of a state: shown as formatted Markdown, edited as plain text. */

import { Pencil } from "lucide-react";
import { type KeyboardEvent, useId, useState } from "react";
import { setDescription } from "../../plan/states.ts";
import { type DraftPlace, drafts } from "../../store/document/drafts.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { onDemand } from "../../ui/on_demand.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

const Markdown = onDemand(async () => (await import("./markdown_text.tsx")).Markdown);

/** Components that are loaded to show a description. */
export const DESCRIPTION_PARTS = [Markdown];

export function Description({ inspected }: { inspected: InspectedState }) {
  const { path, state, tab, readOnly } = inspected;
  const text = state.description ?? "";
  const place: DraftPlace = { machine: tab.session.id, path, field: "description" };
  useSignal(drafts.all);
  const draft = drafts.get(place);
  const [isWriting, setWriting] = useState(false);
  const writes = !readOnly && (isWriting || draft !== undefined);
  const pencil = (
    <IconButton
      label={writes ? "Show the formatted description" : "Edit the description"}
      icon={<Pencil size={14} />}
      pressed={writes}
      onClick={() => setWriting(!writes)}
    />
  );
  const isEmpty = text === "" && !writes;
  return (
    <Fold title="Description" openAtFirst={!isEmpty} actions={readOnly || isEmpty ? null : pencil}>
      {writes ? (
        <Writing inspected={inspected} place={place} onDone={() => setWriting(false)} />
      ) : isEmpty ? (
        <Nothing readOnly={readOnly} onWrite={() => setWriting(true)} />
      ) : (
        <Markdown text={text} />
      )}
    </Fold>
  );
}

function Nothing({ readOnly, onWrite }: { readOnly: boolean; onWrite: () => void }) {
  if (readOnly) return <p className="inspector-none">No description.</p>;
  return (
    <Button kind="quiet" icon={<Pencil size={14} />} onClick={onWrite}>
      Describe this state
    </Button>
  );
}

interface WritingProps {
  readonly inspected: InspectedState;
  readonly place: DraftPlace;
  readonly onDone: () => void;
}

/** Editor of the description. Each key stores a draft. Ctrl+Enter and loss of focus apply it, Escape discards it. */
function Writing({ inspected: { path, state, edit }, place, onDone }: WritingProps) {
  const id = useId();
  const [refusal, run] = useRefusal();
  const base = state.description ?? "";
  const draft = drafts.get(place);
  const stop = () => {
    drafts.drop(place);
    onDone();
  };
  const apply = async () => {
    const text = drafts.get(place)?.text ?? base;
    const refused = text === base ? null : await edit((now) => setDescription(now, path, text));
    if (refused === null) stop();
    return refused;
  };
  const key = (event: KeyboardEvent<HTMLElement>) => {
    const isDone = event.key === "Enter" && (event.ctrlKey || event.metaKey);
    if (event.key !== "Escape" && !isDone) return;
    event.preventDefault();
    event.stopPropagation();
    if (isDone) run(apply());
    else stop();
  };
  return (
    <div className="field">
      <label className="field-label" htmlFor={id}>
        Description, in Markdown
      </label>
      <textarea
        id={id}
        className="field-input inspector-writing"
        // biome-ignore lint/a11y/noAutofocus: the user asked to write here
        autoFocus
        aria-describedby={`${id}-hint`}
        value={draft?.text ?? base}
        onChange={({ currentTarget: { value: text } }) =>
          drafts.keep({ ...place, text, base: draft?.base ?? base })
        }
        onBlur={() => run(apply())}
        onKeyDown={key}
      />
      <span id={`${id}-hint`} className="field-hint">
        Ctrl+Enter or leaving the field applies it, Escape discards it.
      </span>
      <Refusal text={refusal} />
      {draft && draft.base !== base && (
        <p className="inspector-warning" role="note">
          Someone else changed the description in the meantime. It now reads: {base || "(nothing)"}
        </p>
      )}
    </div>
  );
}
