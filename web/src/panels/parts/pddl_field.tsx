/** Field for facts, a goal or an action. */

import { useEffect, useRef } from "react";
import { faultsOf, type PddlFault, type PddlWords } from "../../model/pddl.ts";
import { type PddlEditor, pddlEditor } from "./pddl_editor.ts";
import "./pddl_field.css";

interface PddlFieldProps {
  readonly label: string;
  readonly example: string;
  readonly value: string;
  readonly readOnly?: boolean;
  readonly words: PddlWords;
  /** Returns the problems of a text. The default is the check of facts. */
  readonly faults?: (text: string, words: PddlWords) => readonly PddlFault[];
  readonly onChange: (text: string) => void;
  readonly onApply: () => void;
  readonly onLeave?: () => void;
}

export function PddlField(props: PddlFieldProps) {
  const place = useRef<HTMLDivElement>(null);
  const editor = useRef<PddlEditor | null>(null);
  const latest = useRef(props);
  latest.current = props;
  useEffect(() => {
    const { value, label, example } = latest.current;
    if (!place.current) return;
    const made = pddlEditor(place.current, {
      text: value,
      label,
      example,
      readOnly: latest.current.readOnly ?? false,
      faults: latest.current.faults ?? faultsOf,
      words: () => latest.current.words,
      onType: (text) => latest.current.onChange(text),
      onApply: () => latest.current.onApply(),
      onLeave: () => latest.current.onLeave?.(),
    });
    editor.current = made;
    return () => made.dispose();
  }, []);
  const { value, words } = props;
  useEffect(() => editor.current?.put(value), [value]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: other words need another check
  useEffect(() => editor.current?.checkAgain(), [words]);
  return <div ref={place} className="pddl-text" />;
}
