/** Editor for Python with highlighting, folding, search, completion and inline problems. It does not depend on React. */

import {
  autocompletion,
  closeBrackets,
  closeBracketsKeymap,
  completionKeymap,
} from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { python, pythonLanguage } from "@codemirror/lang-python";
import {
  bracketMatching,
  codeFolding,
  foldGutter,
  foldKeymap,
  indentOnInput,
  indentUnit,
} from "@codemirror/language";
import { linter, lintGutter, lintKeymap } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import {
  type ChangeSpec,
  Compartment,
  EditorState,
  type Extension,
  StateEffect,
} from "@codemirror/state";
import {
  drawSelection,
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  highlightSpecialChars,
  keymap,
  lineNumbers,
  type ViewUpdate,
} from "@codemirror/view";
import type { Repair, ScriptProblem } from "../../../model/generated/protocol.ts";
import { look } from "../../parts/code_look.ts";
import { diagnostics } from "./check.ts";
import { nameCompletion, type ScriptNames } from "./complete.ts";

interface ScriptEditorOptions {
  readonly text: string;
  readonly readOnly: boolean;
  /** Label for screen readers: "Script of Scan". */
  readonly label: string;
  readonly names: () => ScriptNames;
  /** Returns the problems of a text. */
  readonly check: (script: string) => Promise<readonly ScriptProblem[]>;
  /** Applies an edit of the machine that repairs a problem. */
  readonly onRepair: (repair: Repair) => Promise<void>;
  /** Called after each change by the user. */
  readonly onType: (text: string) => void;
  readonly onApply: () => void;
}

export interface ScriptEditor {
  readonly view: EditorView;
  /** Replaces the text as one undoable step. An unchanged text has no effect. */
  readonly put: (text: string) => void;
  readonly setReadOnly: (readOnly: boolean) => void;
  /** Shows a line, counted from 1, and puts the cursor there. */
  readonly goTo: (line: number) => void;
}

const CHECK_AFTER_MS = 300;

export function scriptEditor(place: HTMLElement, options: ScriptEditorOptions): ScriptEditor {
  const access = new Compartment();
  let isPut = false;
  const changeListener = EditorView.updateListener.of((update) => {
    if (update.docChanged && !isPut) options.onType(update.state.doc.toString());
  });
  const view = new EditorView({
    parent: place,
    doc: options.text,
    extensions: [
      keymap.of(applyKeys(options.onApply)),
      pythonText(options.label),
      editing(options),
      access.of(readable(options.readOnly)),
      changeListener,
    ],
  });
  const put = (text: string) => {
    const change = difference(view.state.doc.toString(), text);
    if (!change) return;
    isPut = true;
    view.dispatch({ changes: change });
    isPut = false;
  };
  const goTo = (line: number) => {
    const { from } = view.state.doc.line(Math.max(1, Math.min(view.state.doc.lines, line)));
    const effects = EditorView.scrollIntoView(from, { y: "center" });
    view.dispatch({ selection: { anchor: from }, effects });
  };
  const setReadOnly = (readOnly: boolean) =>
    view.dispatch({ effects: access.reconfigure(readable(readOnly)) });
  return { view, put, setReadOnly, goTo };
}

/** Change between two texts without their common beginning and end. It keeps the position of the cursor. */
export function difference(before: string, after: string): ChangeSpec | null {
  if (before === after) return null;
  const most = Math.min(before.length, after.length);
  let from = 0;
  while (from < most && before[from] === after[from]) from++;
  let same = 0;
  while (same < most - from && before.at(-1 - same) === after.at(-1 - same)) same++;
  return { from, to: before.length - same, insert: after.slice(from, after.length - same) };
}

function applyKeys(onApply: () => void) {
  const run = () => {
    onApply();
    return true;
  };
  return [
    { key: "Mod-Enter", run },
    { key: "Mod-Shift-e", run },
  ];
}

function readable(readOnly: boolean): Extension {
  return EditorState.readOnly.of(readOnly);
}

/** Extensions for Python text, editable or not. */
export function pythonText(label: string): Extension {
  return [
    python(),
    look(),
    lineNumbers(),
    foldGutter(),
    codeFolding(),
    highlightSpecialChars(),
    drawSelection(),
    highlightSelectionMatches(),
    bracketMatching(),
    search({ top: true }),
    indentUnit.of("    "),
    EditorState.tabSize.of(4),
    EditorView.contentAttributes.of({ "aria-label": label, spellcheck: "false", tabindex: "0" }),
    keymap.of([...searchKeymap, ...foldKeymap]),
  ];
}

/** Checks the unchanged text again after the machine has changed. */
const checkAgain = StateEffect.define<null>();

function isChangedElsewhere(update: ViewUpdate): boolean {
  return update.transactions.some(({ effects }) => effects.some((effect) => effect.is(checkAgain)));
}

function editing({ names, check, onRepair }: ScriptEditorOptions): Extension {
  const source = async (view: EditorView) => {
    const { doc } = view.state;
    if (doc.length === 0) return [];
    const mend = (repair: Repair) =>
      void onRepair(repair).then(() => view.dispatch({ effects: checkAgain.of(null) }));
    return diagnostics(doc, await check(doc.toString()), mend);
  };
  return [
    history(),
    indentOnInput(),
    closeBrackets(),
    autocompletion(),
    pythonLanguage.data.of({ autocomplete: nameCompletion(names) }),
    highlightActiveLine(),
    highlightActiveLineGutter(),
    linter(source, { delay: CHECK_AFTER_MS, needsRefresh: isChangedElsewhere }),
    lintGutter(),
    keymap.of([
      ...closeBracketsKeymap,
      ...completionKeymap,
      ...lintKeymap,
      ...historyKeymap,
      ...defaultKeymap,
      indentWithTab,
    ]),
  ];
}
