/** Any value of a run, structured: a tree that folds, with types and sizes. What is folded is not made. */

import { type ReactNode, useState } from "react";
import { keepOpen, openParts } from "./kept_choice.ts";
import { ValueRow } from "./value_row.tsx";
import "./value.css";

interface ValueViewProps {
  /** As it came: what docs/protocol.md says of values. */
  readonly value: unknown;
  /** What it is called; left out: it stands under its name already. */
  readonly name?: string | undefined;
  /** Names it among all values, so that it comes back with the same parts open. */
  readonly keep?: string | undefined;
  /** Whether it is open if nobody has folded it. */
  readonly openAtFirst?: boolean | undefined;
  /** Buttons at the end of its line. */
  readonly actions?: ReactNode;
}

/** The parts of a value by their ways from it; the value itself has the empty way. */
const ROOT = "";

export function ValueView({ value, name, keep, openAtFirst = false, actions }: ValueViewProps) {
  const [parts, setParts] = useState<ReadonlySet<string>>(
    () => openParts(keep ?? ROOT) ?? new Set(openAtFirst ? [ROOT] : []),
  );
  const toggle = (valuePath: string) => {
    const next = new Set(parts);
    if (!next.delete(valuePath)) next.add(valuePath);
    setParts(next);
    if (keep) keepOpen(keep, next);
  };
  return (
    <div className="value">
      <ValueRow
        name={name}
        value={value}
        valuePath={ROOT}
        actions={actions}
        tree={{ isOpen: (valuePath) => parts.has(valuePath), toggle }}
      />
    </div>
  );
}
