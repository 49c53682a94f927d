/** Bar that starts and cancels planning, shows its progress, and accepts the plan. */

import { Check, Route, Square } from "lucide-react";
import { accept, isTaken } from "../../commands/planner.ts";
import { namesTo } from "../../model/machine.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { missingIn } from "../../store/planner/inputs.ts";
import type { Planner } from "../../store/planner/planner.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { planningInWords } from "./words.ts";

interface BarProps {
  readonly tab: OpenTab;
  readonly planner: Planner;
  /** Reason why the plan cannot be inserted into the machine. */
  readonly fault: string | null;
  readonly onPlan: () => void;
}

export function Bar({ tab, planner, fault, onPlan }: BarProps) {
  const { context } = useHost();
  const inputs = useSignal(planner.inputs);
  const planning = useSignal(planner.planning);
  const found = useSignal(planner.found);
  const isIn = useComputed(() => isTaken(tab, planner), [tab, planner]);
  const container = useSignal(planner.container);
  const missing = missingIn(inputs);
  const isCurrent = useSignal(planner.isCurrent);
  const isShown = found !== null && !isIn;
  const isOffered = isShown && isCurrent;
  const isPlanning = planning.state === "planning";
  const place = namesTo(tab.session.machine, container ?? tab.session.machine.root).at(-1);
  const messages = [
    planning.state === "idle" ? missing : planningInWords(planning, 0),
    fault,
    isOffered && fault === null ? `The plan is on the canvas, in ${place}.` : null,
    isShown && !isCurrent ? "The plan on the canvas is for an earlier request." : null,
    isIn ? "The plan is in the machine. Undo takes it back." : null,
  ];
  return (
    <div className="planner-bar">
      <p className="planner-status" role="status">
        {isPlanning ? (
          <Running planner={planner} />
        ) : (
          messages.filter((each) => each !== null).join(" ")
        )}
      </p>
      <div className="planner-buttons">
        {isPlanning ? (
          <Button icon={<Square size={13} />} onClick={() => planner.cancel()}>
            Cancel
          </Button>
        ) : (
          <Button
            kind={isOffered ? "plain" : "primary"}
            icon={<Route size={14} />}
            keys="Ctrl+Enter"
            title={missing ?? "Ask the engine for a plan"}
            disabled={missing !== null}
            onClick={onPlan}
          >
            {found ? "Plan again" : "Plan"}
          </Button>
        )}
        {isOffered && (
          <Button
            kind="primary"
            icon={<Check size={14} />}
            title={fault ?? `Put the plan into ${place}`}
            disabled={fault !== null}
            onClick={() => void accept(context(), tab, planner)}
          >
            Accept
          </Button>
        )}
        {isShown && (
          <Button kind="quiet" onClick={() => planner.dismiss()}>
            Dismiss
          </Button>
        )}
      </div>
    </div>
  );
}

function Running({ planner }: { readonly planner: Planner }) {
  const now_ms = useSignal(clock1s);
  const planning = useSignal(planner.planning);
  return <>{planningInWords(planning, now_ms)}</>;
}
