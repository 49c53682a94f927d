/** Editor of a script, bound to its state. Loaded when a script is first shown. */

import { useEffect, useMemo, useRef } from "react";
import { globalsOf } from "../../model/globals.ts";
import { outcomesOf, portsOf } from "../../model/machine.ts";
import { scriptLineRevealRequest } from "../../store/page/reveal_requests.ts";
import { useSignal } from "../../ui/signals.ts";
import type { ScriptNames } from "./code/complete.ts";
import { type ScriptEditor, scriptEditor } from "./code/script_editor.ts";
import type { InspectedState } from "./inspector_context.ts";
import { checkScript } from "./script_check.ts";

interface ScriptCodeProps {
  readonly inspected: InspectedState;
  readonly text: string;
  readonly onType: (text: string) => void;
  readonly onApply: () => void;
}

/** Keeps one editor for a state, and updates its text after changes from outside. */
export function ScriptCode({ inspected, text, onType, onApply }: ScriptCodeProps) {
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

/** Initial height, which fits the text. The user can drag the corner. */
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
