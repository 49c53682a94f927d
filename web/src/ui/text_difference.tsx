/** The difference of two texts: added and removed lines are marked, and long unchanged parts are folded. */

import { python } from "@codemirror/lang-python";
import { HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import { unifiedMergeView } from "@codemirror/merge";
import { EditorState, type Extension } from "@codemirror/state";
import { EditorView, lineNumbers } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { useEffect, useRef } from "react";
import "./text_difference.css";

interface TextDifferenceProps {
  /** Accessible name. */
  readonly label: string;
  readonly old: string;
  readonly now: string;
  readonly isPython?: boolean;
}

const COLOURS = HighlightStyle.define([
  { tag: [tags.keyword, tags.operatorKeyword, tags.modifier], color: "var(--code-keyword)" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--code-text)" },
  { tag: [tags.number, tags.bool, tags.null], color: "var(--code-number)" },
  { tag: [tags.comment, tags.meta], color: "var(--code-comment)", fontStyle: "italic" },
]);

const THEME = EditorView.theme({
  "&": { backgroundColor: "var(--sunken)", color: "var(--text)", fontSize: "var(--text-small)" },
  ".cm-scroller": { fontFamily: "var(--font-code)", lineHeight: "1.5" },
  ".cm-gutters": {
    backgroundColor: "var(--sunken)",
    color: "var(--text-faint)",
    borderRight: "1px solid var(--border)",
  },
  "&.cm-merge-b .cm-changedLine, .cm-inlineChangedLine": {
    backgroundColor: "var(--success-soft)",
  },
  ".cm-deletedChunk": { backgroundColor: "var(--danger-soft)" },
  "&.cm-merge-b .cm-changedText, .cm-deletedChunk .cm-deletedText": { background: "none" },
  ".cm-deletedChunk .cm-deletedText, .cm-insertedLine, .cm-deletedLine": {
    textDecoration: "none",
  },
  ".cm-changedLineGutter": { background: "var(--added)" },
  ".cm-deletedLineGutter": { background: "var(--removed)" },
  ".cm-collapsedLines": {
    background: "var(--hover)",
    color: "var(--text-soft)",
    padding: "2px 8px",
  },
});

export function TextDifference({ label, old, now, isPython = false }: TextDifferenceProps) {
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const parent = place.current;
    if (!parent) return;
    const view = new EditorView({ parent, state: stateOf(label, old, now, isPython) });
    return () => view.destroy();
  }, [label, old, now, isPython]);
  return <div className="text-difference" ref={place} />;
}

function stateOf(label: string, old: string, now: string, isPython: boolean): EditorState {
  const language: Extension = isPython ? [python(), syntaxHighlighting(COLOURS)] : [];
  return EditorState.create({
    doc: now,
    extensions: [
      EditorState.readOnly.of(true),
      EditorView.contentAttributes.of({ "aria-label": label }),
      EditorView.lineWrapping,
      lineNumbers(),
      language,
      THEME,
      unifiedMergeView({
        original: old,
        mergeControls: false,
        collapseUnchanged: { margin: 3, minSize: 8 },
      }),
    ],
  });
}
