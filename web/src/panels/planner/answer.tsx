/** Plan with its steps and their reasons, and the differences from the previous plan. */

import { useMemo, useState } from "react";
import { isTaken } from "../../commands/planner.ts";
import type { PlanFound, PlanStep } from "../../model/generated/protocol.ts";
import { type ComparedStep, compareSteps } from "../../model/step_difference.ts";
import type { OpenTab } from "../../store/page/page.ts";
import type { Planner } from "../../store/planner/planner.ts";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { reveal } from "../reveal.ts";
import { Findings } from "./findings.tsx";
import { Step } from "./step.tsx";
import { foundInWords } from "./words.ts";

interface AnswerProps {
  readonly tab: OpenTab;
  readonly planner: Planner;
}

export function Answer({ tab, planner }: AnswerProps) {
  const planning = useSignal(planner.planning);
  const found = useSignal(planner.found);
  const before = useSignal(planner.before);
  if (planning.state === "refused") {
    return (
      <Section title="Problems" count={planning.findings.length}>
        <Findings findings={planning.findings} />
      </Section>
    );
  }
  if (!found) return null;
  const more = "end" in planning ? planning.end.findings : undefined;
  return (
    <Section title="Plan" count={found.steps.length}>
      <p className="planner-soft">{foundInWords(found)}</p>
      <Findings findings={[...(found.findings ?? []), ...(more ?? [])]} />
      <Steps key={found.after_ms} tab={tab} planner={planner} found={found} before={before} />
    </Section>
  );
}

interface StepsProps extends AnswerProps {
  readonly found: PlanFound;
  readonly before: PlanFound | null;
}

function Steps({ tab, planner, found, before }: StepsProps) {
  const host = useHost();
  const taken = useSignal(planner.taken);
  const [chosen, setChosen] = useState<string | null>(null);
  const rows = useMemo(
    () => compareSteps(before?.steps ?? found.steps, found.steps),
    [before, found],
  );
  const show = (step: PlanStep) => {
    if (taken !== null && isTaken(tab, planner)) {
      const inside = step.path.slice(step.path.indexOf("/"));
      reveal(host, { kind: "state", path: taken.path + inside });
      return;
    }
    const { ghost } = tab.view;
    if (ghost.value) ghost.value = { ...ghost.value, chosen: step.path };
    host.context().canvas?.revealGhost(step.path);
  };
  const choose = (key: string) => {
    const row = rows.find((each) => keyOf(each) === key);
    setChosen(chosen === key ? null : key);
    if (row && row.difference !== "removed") show(row.step);
  };
  const goTo = (index: number) => {
    setChosen(`${index}`);
    const step = found.steps[index];
    if (step) show(step);
  };
  return (
    <>
      <Difference rows={rows} />
      {found.steps.length === 0 && <p className="planner-soft">The goal is reached already.</p>}
      <ol className="planner-steps" aria-label="Steps of the plan">
        {rows.map((row) => (
          <Step
            key={keyOf(row)}
            row={row}
            found={row.difference === "removed" && before ? before : found}
            isOpen={chosen === keyOf(row)}
            onToggle={() => choose(keyOf(row))}
            onGoTo={goTo}
          />
        ))}
      </ol>
    </>
  );
}

function keyOf({ difference, index }: ComparedStep<PlanStep>): string {
  return difference === "removed" ? `removed ${index}` : `${index}`;
}

/** Number of changes since the previous plan. Hidden without changes. */
function Difference({ rows }: { readonly rows: readonly ComparedStep<PlanStep>[] }) {
  const many = (wanted: string) => rows.filter(({ difference }) => difference === wanted).length;
  const [added, removed, kept] = [many("added"), many("removed"), many("kept")];
  if (added === 0 && removed === 0) return null;
  return (
    <p className="planner-difference">
      Against the plan before: <span className="is-added">{added} added</span>,{" "}
      <span className="is-removed">{removed} removed</span>, {kept} kept
    </p>
  );
}
