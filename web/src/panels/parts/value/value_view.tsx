/** Any value of a run as a tree with types and sizes. Collapsed parts are not rendered. */

import { type ReactNode, useState } from "react";
import { keepOpen, openParts } from "./kept_choice.ts";
import { ValueRow } from "./value_row.tsx";
import "./value.css";

interface ValueViewProps {
  /** Value as received, encoded as in docs/protocol.md. */
  readonly value: unknown;
  /** Name of the value. Undefined if a title above shows it already. */
  readonly name?: string | undefined;
  /** Key under which the expanded parts are stored. */
  readonly keep?: string | undefined;
  /** True to expand the value until the user collapses it. */
  readonly openAtFirst?: boolean | undefined;
  /** Buttons at the end of the first line. */
  readonly actions?: ReactNode;
}

/** Path of the value itself. Parts are identified by their paths. */
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
