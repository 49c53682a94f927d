/** Dialog before a rename that shows its effect on the script, line by line. */

import { type ReactNode, useRef, useState } from "react";
import type { ElementRef } from "../../model/element.ts";
import { nameOf } from "../../model/ends.ts";
import { lineAt, renameInScript, type ScriptUse, scriptUses } from "../../model/python.ts";
import { renameElement } from "../../plan/rename_in_script.ts";
import { drafts, type FieldDraft } from "../../store/document/drafts.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import type { CommitQuestion } from "../../ui/field.tsx";
import type { InspectedState } from "./inspector_context.ts";

type RenamingChoice = "script" | "name" | "nothing";

interface RenamingQuestion {
  readonly from: string;
  readonly to: string;
  readonly script: string;
  readonly uses: readonly ScriptUse[];
  readonly answer: (choice: RenamingChoice) => void;
}

/** Returns a function that renames a port or outcome, and the dialog to render. */
export function useRenaming(
  inspected: InspectedState,
): readonly [(element: ElementRef, name: string) => Made | CommitQuestion, ReactNode] {
  const [question, setQuestion] = useState<RenamingQuestion | null>(null);
  const asked = useRef<CommitQuestion | null>(null);
  const ask = (from: string, to: string, script: string, uses: readonly ScriptUse[]) =>
    new Promise<RenamingChoice>((resolve) => {
      const answer = (choice: RenamingChoice) => {
        setQuestion(null);
        resolve(choice);
      };
      setQuestion({ from, to, script, uses, answer });
    });
  const afterAsking = async (element: ElementRef, name: string, from: string) => {
    const { script, uses } = calls(inspected, element, from);
    const choice = await ask(from, name, script, uses);
    if (choice === "nothing") return null;
    const inScript = choice === "script";
    const refusal = await inspected.edit((now) => renameElement(now, element, name, inScript));
    if (refusal === null && inScript) renameInDraft(inspected, element, from, name);
    return refusal;
  };
  const rename = (element: ElementRef, text: string) => {
    const name = text.trim();
    const from = nameOf(inspected.machine, element);
    const isPlain = name === "" || calls(inspected, element, from).uses.length === 0;
    if (isPlain) return inspected.edit((now) => renameElement(now, element, name, false));
    // The focus change to the dialog commits the cell again: that must not open another dialog.
    asked.current ??= {
      asked: afterAsking(element, name, from).finally(() => {
        asked.current = null;
      }),
    };
    return asked.current;
  };
  return [rename, question && <Asking {...question} />];
}

function draftOf({ tab, path }: InspectedState): FieldDraft | undefined {
  return drafts.get({ machine: tab.session.id, path, field: "script" });
}

/** Uses of the name in the script as the user sees it, including the draft. */
function calls(inspected: InspectedState, element: ElementRef, name: string) {
  const script = draftOf(inspected)?.text ?? inspected.state.script ?? "";
  const uses = scriptUses(script).filter((use) => use.of === element.kind && use.name === name);
  return { script, uses };
}

function renameInDraft(
  inspected: InspectedState,
  element: ElementRef,
  from: string,
  to: string,
): void {
  const draft = draftOf(inspected);
  if (!draft) return;
  const { uses } = calls(inspected, element, from);
  const base = inspected.tab.session.machine.state(inspected.path)?.script ?? "";
  drafts.keep({ ...draft, base, text: renameInScript(draft.text, uses, to) });
}

function Asking({ from, to, script, uses, answer }: RenamingQuestion) {
  const lines = new Map(uses.map((use) => [lineAt(script, use.from).line, use]));
  const after = (use: ScriptUse) => {
    const { line } = lineAt(script, use.from);
    const inLine = uses.filter((other) => lineAt(script, other.from).line === line);
    const renamed = renameInScript(script, inLine, to);
    return lineAt(renamed, Math.min(...inLine.map((other) => other.from))).text;
  };
  return (
    <Dialog
      title={`Rename ${from} to ${to}`}
      width={640}
      onClose={() => answer("nothing")}
      footer={
        <>
          <Button onClick={() => answer("nothing")}>Cancel</Button>
          <Button onClick={() => answer("name")}>Name only</Button>
          <Button kind="primary" onClick={() => answer("script")}>
            Name and script
          </Button>
        </>
      }
    >
      <p>
        The script uses the name in {uses.length === 1 ? "one place" : `${uses.length} places`}.
        Connections are kept in both cases.
      </p>
      <ul className="inspector-changes">
        {[...lines].map(([line, use]) => (
          <li key={line}>
            <span className="inspector-line">{line}</span>
            <code className="inspector-removed">{lineAt(script, use.from).text}</code>
            <code className="inspector-added">{after(use)}</code>
          </li>
        ))}
      </ul>
    </Dialog>
  );
}
