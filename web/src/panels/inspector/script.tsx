/** The script of a state: written as a draft that the browser keeps until it is applied, one step of the history. */

import { Check, RotateCcw } from "lucide-react";
import { useEffect, useMemo, useRef } from "react";
import { globalsOf } from "../../model/globals.ts";
import { outcomesOf, portsOf } from "../../model/machine.ts";
import { setScript } from "../../plan/states.ts";
import { type DraftPlace, drafts } from "../../store/drafts.ts";
import { scriptLineRevealRequest } from "../../store/script_line_reveal_request.ts";
import { Button } from "../../ui/button.tsx";
import { useSignal } from "../../ui/signals.ts";
import type { ScriptNames } from "./code/complete.ts";
import { type ScriptEditor, scriptEditor } from "./code/script_editor.ts";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";
import { checkScript } from "./script_check.ts";
import { ScriptConflict } from "./script_conflict.tsx";

export function Script({ inspected }: { inspected: InspectedState }) {
  const { path, state, tab, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  useSignal(drafts.all);
  const base = state.script ?? "";
  const place: DraftPlace = { machine: tab.session.id, path, field: "script" };
  const draft = readOnly ? undefined : drafts.get(place);
  const text = draft?.text ?? base;
  const isConflict = draft !== undefined && draft.base !== base && draft.text !== base;
  const apply = async () => {
    const latest = drafts.get(place);
    if (!latest) return null;
    const said =
      latest.text === base ? null : await edit((now) => setScript(now, path, latest.text));
    if (said === null && drafts.get(place)?.text === latest.text) drafts.drop(place);
    return said;
  };
  const type = (typed: string) => {
    if (typed === base) drafts.drop(place);
    else drafts.keep({ ...place, text: typed, base: draft?.base ?? base });
  };
  return (
    <Fold title="Script">
      <Code
        key={path}
        inspected={inspected}
        text={text}
        onType={type}
        onApply={() => run(apply())}
      />
      {draft && (
        <div className="inspector-bar">
          <span className="inspector-unapplied">Not applied yet</span>
          <Button icon={<RotateCcw size={14} />} onClick={() => drafts.drop(place)}>
            Reset
          </Button>
          <Button
            kind="primary"
            icon={<Check size={14} />}
            keys="Ctrl+Enter"
            title="Apply the script to the state"
            onClick={() => run(apply())}
          >
            Apply
          </Button>
        </div>
      )}
      <Refusal text={refusal} />
      {isConflict && draft && (
        <ScriptConflict
          theirs={base}
          mine={draft.text}
          onMine={() => run(apply())}
          onTheirs={() => drafts.drop(place)}
          onKeep={(merged) => drafts.keep({ ...place, text: merged, base })}
        />
      )}
    </Fold>
  );
}

interface CodeProps {
  readonly inspected: InspectedState;
  readonly text: string;
  readonly onType: (text: string) => void;
  readonly onApply: () => void;
}

/** The editor lives as long as the same state is shown; what comes from outside is put in. */
function Code({ inspected, text, onType, onApply }: CodeProps) {
  const place = useRef<HTMLDivElement>(null);
  const editor = useRef<ScriptEditor | null>(null);
  const latest = useRef({ inspected, onType, onApply, text });
  latest.current = { inspected, onType, onApply, text };
  const { page, path, tab } = inspected;
  const check = useMemo(() => {
    const state = tab.session.fixed === null ? { machine: tab.session.id, path } : null;
    return checkScript(page, state);
  }, [page, path, tab]);
  useEffect(() => {
    if (!place.current) return;
    const made = scriptEditor(place.current, {
      text: latest.current.text,
      readOnly: latest.current.inspected.readOnly,
      label: `Script of ${latest.current.inspected.state.name}`,
      names: () => namesOf(latest.current.inspected),
      check,
      onRepair: async ({ name, edit }) => {
        await latest.current.inspected.tab.session.edit(name, edit);
      },
      onType: (typed) => latest.current.onType(typed),
      onApply: () => latest.current.onApply(),
    });
    editor.current = made;
    return () => made.view.destroy();
  }, [check]);
  useEffect(() => editor.current?.put(text), [text]);
  useEffect(() => editor.current?.setReadOnly(inspected.readOnly), [inspected.readOnly]);
  const wanted = useSignal(scriptLineRevealRequest);
  useEffect(() => {
    if (wanted?.path !== inspected.path) return;
    editor.current?.goTo(wanted.line);
    scriptLineRevealRequest.value = null;
  }, [wanted, inspected.path]);
  const height = useRef(heightOf(text));
  return <div ref={place} className="inspector-code" style={{ height: height.current }} />;
}

const LINE_PX = 18;
const [SHORT_PX, TALL_PX] = [120, 420];

/** As tall as its text at first; whoever wants it otherwise drags its corner. */
function heightOf(text: string): number {
  const lines = text.split("\n").length + 2;
  return Math.min(TALL_PX, Math.max(SHORT_PX, lines * LINE_PX));
}

function namesOf({ state, machine }: InspectedState): ScriptNames {
  const ports = (kind: "input" | "output") =>
    portsOf(state, kind).map(({ name, data_type }) => ({ name, detail: data_type }));
  return {
    inputs: ports("input"),
    outputs: ports("output"),
    outcomes: outcomesOf(state)
      .toSorted((one, other) => Number(one.id < 0) - Number(other.id < 0))
      .map(({ name, id }) => ({ name, detail: `outcome ${id}` })),
    globals: globalsOf(machine).map(({ name }) => ({ name, detail: "global variable" })),
  };
}
