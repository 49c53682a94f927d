/** Changes of the selected step. */

import { useMemo } from "react";
import { differences } from "../../model/difference.ts";
import type { StepNode } from "../../model/steps.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { useHost } from "../context.tsx";
import { DifferenceList } from "../difference_list.tsx";
import { reveal } from "../reveal.ts";

export function StepDetail({ tab, node }: { readonly tab: OpenTab; readonly node: StepNode }) {
  const host = useHost();
  const stepChange = tab.session.stepChange(node.revision);
  const all = useMemo(
    () => (stepChange ? differences(stepChange.before, stepChange.after) : []),
    [stepChange],
  );
  if (!stepChange) {
    const text =
      node.step === null
        ? "The machine as it was read from its files."
        : "This page does not know what this step changed: it was made before the machine was opened here, or long ago.";
    return <div className="edits-step edits-hint">{text}</div>;
  }
  if (all.length === 0) {
    return <div className="edits-step edits-hint">This step has no visible changes.</div>;
  }
  return (
    <div className="edits-step">
      <DifferenceList
        label="Changes of this step"
        all={all}
        old={stepChange.before}
        now={stepChange.after}
        onReveal={({ element }) => reveal(host, element)}
      />
    </div>
  );
}
