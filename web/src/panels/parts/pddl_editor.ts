/** Editor for facts, goals and actions in PDDL, with completion, bracket matching and inline problems. It does not depend on React. */

import {
  autocompletion,
  type Completion,
  type CompletionContext,
  type CompletionResult,
  closeBrackets,
  closeBracketsKeymap,
  completionKeymap,
  startCompletion,
} from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { bracketMatching } from "@codemirror/language";
import { forceLinting, linter, lintKeymap } from "@codemirror/lint";
import { EditorState, type Extension } from "@codemirror/state";
import { drawSelection, EditorView, keymap, placeholder } from "@codemirror/view";
import { offersAt, type PddlFault, type PddlOffer, type PddlWords } from "../../model/pddl.ts";
import { look } from "./code_look.ts";

interface PddlEditorOptions {
  readonly text: string;
  readonly label: string;
  readonly example: string;
  readonly readOnly: boolean;
  readonly words: () => PddlWords;
  /** Returns the problems of a text. */
  readonly faults: (text: string, words: PddlWords) => readonly PddlFault[];
  readonly onType: (text: string) => void;
  /** Called on Ctrl+Enter. */
  readonly onApply: () => void;
  /** Called on loss of focus. */
  readonly onLeave: () => void;
}

export interface PddlEditor {
  /** Replaces the text. An unchanged text has no effect. */
  readonly put: (text: string) => void;
  /** Checks the text again after a change of the known words. */
  readonly checkAgain: () => void;
  readonly dispose: () => void;
}

const CHECK_AFTER_MS = 300;

export function pddlEditor(place: HTMLElement, options: PddlEditorOptions): PddlEditor {
  let isPut = false;
  const onType = (text: string) => {
    if (!isPut) options.onType(text);
  };
  const view = new EditorView({
    parent: place,
    doc: options.text,
    extensions: extensions({ ...options, onType }),
  });
  return {
    put: (text) => {
      const { doc } = view.state;
      if (doc.toString() === text) return;
      isPut = true;
      view.dispatch({ changes: { from: 0, to: doc.length, insert: text } });
      isPut = false;
    },
    checkAgain: () => forceLinting(view),
    dispose: () => view.destroy(),
  };
}

function extensions(options: PddlEditorOptions): Extension {
  const { label, example, words, onType, onApply } = options;
  const apply = () => {
    onApply();
    return true;
  };
  return [
    look(),
    history(),
    drawSelection(),
    bracketMatching(),
    closeBrackets(),
    placeholder(example),
    EditorView.lineWrapping,
    EditorView.contentAttributes.of({ "aria-label": label, spellcheck: "false", tabindex: "0" }),
    EditorState.languageData.of(() => [{ closeBrackets: { brackets: ["("] } }]),
    autocompletion({ override: [(context) => completion(context, words())], icons: false }),
    EditorState.readOnly.of(options.readOnly),
    EditorView.domEventHandlers({ blur: () => options.onLeave() }),
    linter((shown) => marked(options.faults(shown.state.doc.toString(), words())), {
      delay: CHECK_AFTER_MS,
    }),
    EditorView.updateListener.of((update) => {
      if (!update.docChanged) return;
      onType(update.state.doc.toString());
      // Offers completions automatically after a bracket or a space.
      const isTyped = update.transactions.some((each) => each.isUserEvent("input.type"));
      const { head } = update.state.selection.main;
      const isAtStart = /[( ]/.test(update.state.doc.sliceString(head - 1, head));
      if (isTyped && isAtStart) queueMicrotask(() => startCompletion(update.view));
    }),
    keymap.of([
      { key: "Mod-Enter", run: apply },
      ...closeBracketsKeymap,
      ...completionKeymap,
      ...lintKeymap,
      ...historyKeymap,
      ...defaultKeymap,
    ]),
  ];
}

function marked(faults: readonly PddlFault[]) {
  return faults.map((fault) => ({ ...fault, severity: "error" as const }));
}

const KINDS: Readonly<Record<PddlOffer["kind"], string>> = {
  predicate: "function",
  word: "keyword",
  type: "type",
  object: "variable",
};

function completion(context: CompletionContext, words: PddlWords): CompletionResult | null {
  const before = context.state.doc.sliceString(0, context.pos);
  const { typed, offers } = offersAt(before, words);
  if (offers.length === 0) return null;
  const options = offers.map(
    ({ label, detail, kind }): Completion => ({
      label,
      detail,
      type: KINDS[kind],
      boost: kind === "word" ? -1 : 0,
    }),
  );
  return { from: context.pos - typed.length, options, validFor: /^[^\s()]*$/ };
}
