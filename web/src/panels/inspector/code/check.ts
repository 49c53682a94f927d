/** Problems of a script at their positions in the text, with a button for each available repair. */

import type { Diagnostic } from "@codemirror/lint";
import type { Text } from "@codemirror/state";
import type { Repair, ScriptProblem, Severity } from "../../../model/generated/protocol.ts";

const SHOWN: Readonly<Record<Severity, Diagnostic["severity"]>> = {
  error: "error",
  warning: "warning",
  note: "info",
};

/** Diagnostics for the editor. A problem without an end position extends to the end of its line. */
export function diagnostics(
  text: Text,
  problems: readonly ScriptProblem[],
  onRepair: (repair: Repair) => void,
): Diagnostic[] {
  return problems.map(({ line, column, end_line, end_column, message, severity, repairs }) => {
    const first = lineOf(text, line);
    const from = Math.min(first.to, first.from + Math.max(0, column - 1));
    const last = end_line == null ? first : lineOf(text, end_line);
    const to = end_column == null ? last.to : last.from + Math.max(0, end_column - 1);
    const end = Math.min(last.to, Math.max(from, to));
    const actions = (repairs ?? []).map((repair) => ({
      name: repair.name,
      apply: () => onRepair(repair),
    }));
    return { ...seen(text, from, end), severity: SHOWN[severity], message, actions };
  });
}

function lineOf(text: Text, line: number) {
  return text.line(Math.max(1, Math.min(text.lines, line)));
}

/** Extends an empty range to one character, to make it visible. */
function seen(
  text: Text,
  from: number,
  to: number,
): { readonly from: number; readonly to: number } {
  if (to > from) return { from, to };
  return from < text.length ? { from, to: from + 1 } : { from: Math.max(0, from - 1), to: from };
}
