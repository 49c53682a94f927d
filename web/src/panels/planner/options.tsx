/** Options of planning: engine, time limit, and the handling of failed steps. */

import type { PlanThen } from "../../model/generated/protocol.ts";
import type { Planner } from "../../store/planner/planner.ts";
import { Checkbox, Select, TextField } from "../../ui/field.tsx";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";

const ENGINES = ["kairos", "fast-downward", "pyperplan", "tamer", "aries", "enhsp", "lpg"];

const THEN: readonly { readonly value: PlanThen; readonly title: string }[] = [
  { value: "give_up", title: "give up" },
  { value: "ask", title: "ask a person" },
  { value: "replan", title: "plan again" },
];

export function Options({ planner }: { readonly planner: Planner }) {
  const inputs = useSignal(planner.inputs);
  return (
    <Section title="Engine and recovery" defaultOpen={false}>
      <div className="planner-fields">
        <TextField
          label="Name of the plan"
          value={inputs.name}
          onCommit={(name) => planner.change({ name })}
        />
        <div className="planner-pair">
          <TextField
            label="Engine"
            value={inputs.engine}
            suggestions={ENGINES}
            onCommit={(engine) => planner.change({ engine: engine.trim() || "kairos" })}
          />
          <TextField
            label="Time limit (s)"
            value={String(inputs.limit_s)}
            check={(text) => (isLimit(text) ? null : "From 0.001 to 3600 s.")}
            onCommit={(text) => planner.change({ limit_s: Number(text) })}
          />
        </div>
        <Checkbox
          label="Keep improving the plan until the time limit"
          checked={inputs.anytime}
          onChange={(anytime) => planner.change({ anytime })}
        />
        <Checkbox
          label="Run independent steps in parallel"
          checked={inputs.parallel}
          onChange={(parallel) => planner.change({ parallel })}
        />
        <div className="planner-pair">
          <TextField
            label="Retries of a failed step"
            value={String(inputs.retries)}
            check={(text) => (/^\d{1,3}$/.test(text) ? null : "From 0 to 999.")}
            onCommit={(text) => planner.change({ retries: Number(text) })}
          />
          <Select
            label="Then"
            value={inputs.lastResort}
            options={THEN}
            onChange={(lastResort) => planner.change({ lastResort })}
          />
        </div>
        {inputs.lastResort === "replan" && (
          <TextField
            label="Library that observes the facts"
            placeholder="root/observe"
            hint="Its output “facts” is the world as it is then."
            value={inputs.observe}
            onCommit={(observe) => planner.change({ observe })}
          />
        )}
      </div>
    </Section>
  );
}

function isLimit(text: string): boolean {
  const limit = Number(text);
  return text.trim() !== "" && limit >= 0.001 && limit <= 3_600;
}
