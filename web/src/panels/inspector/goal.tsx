/** Target of an outcome in the container around its state. */

import { keyOf } from "../../model/element.ts";
import { connectionsIn } from "../../model/ends.ts";
import type { OutcomeDocument } from "../../model/generated/protocol.ts";
import { connect, reconnect } from "../../plan/connect.ts";
import { removeElements } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { EndSelect } from "./end_select.tsx";
import type { InspectedState } from "./inspector_context.ts";

interface GoalProps {
  readonly inspected: InspectedState;
  readonly container: string;
  readonly outcome: OutcomeDocument;
  readonly label: string;
  readonly hideLabel?: boolean | undefined;
  readonly run: (made: Made) => void;
}

export function Goal({ inspected, container, outcome: { id }, label, hideLabel, run }: GoalProps) {
  const { path, machine, readOnly, edit } = inspected;
  if (machine.state(container)?.kind === "library") return null;
  const from = { kind: "outcome", path, id } as const;
  const key = keyOf(from);
  const now = connectionsIn(machine, container, "transition").find(
    ({ ends }) => keyOf(ends.from) === key,
  );
  return (
    <EndSelect
      machine={machine}
      container={container}
      kind="transition"
      end="to"
      label={label}
      hideLabel={hideLabel}
      nothing="nowhere"
      value={now?.ends.to ?? null}
      disabled={readOnly}
      onChange={(to) => {
        if (to && now) run(edit((latest) => reconnect(latest, now.element, "to", to)));
        else if (to) run(edit((latest) => connect(latest, from, to)));
        else if (now) run(edit((latest) => removeElements(latest, [now.element])));
      }}
    />
  );
}
