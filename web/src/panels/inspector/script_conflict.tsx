/** Conflict with a change of the script by another user during editing: both versions side by side, and the choices. */

import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { MergeView } from "@codemirror/merge";
import { EditorState, type Extension } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";
import { useEffect, useRef, useState } from "react";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { pythonText } from "./code/script_editor.ts";

interface ScriptConflictProps {
  /** Current text in the machine. */
  readonly theirs: string;
  readonly mine: string;
  readonly onMine: () => void;
  readonly onTheirs: () => void;
  /** Continues with a text merged from both. */
  readonly onKeep: (merged: string) => void;
}

export function ScriptConflict({ theirs, mine, onMine, onTheirs, onKeep }: ScriptConflictProps) {
  const [isOpen, setOpen] = useState(false);
  const [merged, setMerged] = useState(mine);
  const open = () => {
    setMerged(mine);
    setOpen(true);
  };
  const then = (act: () => void) => () => {
    setOpen(false);
    act();
  };
  return (
    <div className="inspector-warning" role="alert">
      Someone else changed this script while you were editing. Your version is kept here.
      <div className="inspector-bar">
        <Button onClick={open}>Compare…</Button>
        <Button onClick={onTheirs}>Take theirs</Button>
        <Button onClick={onMine}>Apply mine</Button>
      </div>
      {isOpen && (
        <Dialog
          title="Two versions of the script"
          width={1100}
          onClose={() => setOpen(false)}
          footer={
            <>
              <Button onClick={() => setOpen(false)}>Cancel</Button>
              <Button onClick={then(onTheirs)}>Take theirs</Button>
              <Button kind="primary" onClick={then(() => onKeep(merged))}>
                Keep mine
              </Button>
            </>
          }
        >
          <p className="inspector-sides">
            <span>Theirs (in the machine now)</span>
            <span>Mine (editable)</span>
          </p>
          <Sides theirs={theirs} mine={mine} onChange={setMerged} />
        </Dialog>
      )}
    </div>
  );
}

interface SidesProps {
  readonly theirs: string;
  readonly mine: string;
  readonly onChange: (text: string) => void;
}

function Sides({ theirs, mine, onChange }: SidesProps) {
  const place = useRef<HTMLDivElement>(null);
  const latest = useRef(onChange);
  latest.current = onChange;
  const begun = useRef(mine);
  useEffect(() => {
    if (!place.current) return;
    const changeListener = EditorView.updateListener.of(({ docChanged, state }) => {
      if (docChanged) latest.current(state.doc.toString());
    });
    const view = new MergeView({
      parent: place.current,
      a: { doc: theirs, extensions: [pythonText("Theirs"), EditorState.readOnly.of(true)] },
      b: { doc: begun.current, extensions: [pythonText("Mine"), writing(), changeListener] },
      revertControls: "a-to-b",
      renderRevertControl: takeButton,
      collapseUnchanged: { margin: 3, minSize: 6 },
    });
    return () => view.destroy();
  }, [theirs]);
  return <div ref={place} className="inspector-merge" />;
}

function writing(): Extension {
  return [history(), keymap.of([...historyKeymap, ...defaultKeymap])];
}

function takeButton(): HTMLElement {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "inspector-take";
  button.setAttribute("aria-label", "Take theirs here");
  button.title = "Take theirs here";
  button.textContent = "→";
  return button;
}
