/** Script of a state. Edits are a draft in the browser until they are applied as one step of the history. */

import { Check, RotateCcw } from "lucide-react";
import { setScript } from "../../plan/states.ts";
import { type DraftPlace, drafts } from "../../store/document/drafts.ts";
import { Button } from "../../ui/button.tsx";
import { onDemand } from "../../ui/on_demand.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

const ScriptCode = onDemand(async () => (await import("./script_code.tsx")).ScriptCode);
const ScriptConflict = onDemand(async () => (await import("./script_conflict.tsx")).ScriptConflict);

/** Components that are loaded to show the script. */
export const SCRIPT_PARTS = [ScriptCode, ScriptConflict];

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
    const refused =
      latest.text === base ? null : await edit((now) => setScript(now, path, latest.text));
    if (refused === null && drafts.get(place)?.text === latest.text) drafts.drop(place);
    return refused;
  };
  const type = (typed: string) => {
    if (typed === base) drafts.drop(place);
    else drafts.keep({ ...place, text: typed, base: draft?.base ?? base });
  };
  return (
    <Fold title="Script">
      <ScriptCode
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
