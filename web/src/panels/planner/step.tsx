/** Step of a plan: its skill and arguments. Expanded, it shows its conditions and effects, with the steps that they connect to. */

import type { PlanFound, PlanStep } from "../../model/generated/protocol.ts";
import type { ComparedStep } from "../../model/step_difference.ts";
import { Button } from "../../ui/button.tsx";
import { LibraryLink } from "./findings.tsx";
import { short } from "./words.ts";

interface StepProps {
  readonly row: ComparedStep<PlanStep>;
  /** Plan that contains the step. */
  readonly found: PlanFound;
  readonly isOpen: boolean;
  readonly onToggle: () => void;
  /** Selects another step of the plan. */
  readonly onGoTo: (index: number) => void;
}

export function Step({ row, found, isOpen, onToggle, onGoTo }: StepProps) {
  const { step, difference, index } = row;
  return (
    <li className={`planner-step is-${difference}`}>
      <button
        type="button"
        className="planner-step-head"
        aria-expanded={isOpen}
        title={`(${[step.action, ...step.objects].join(" ")})`}
        onClick={onToggle}
      >
        <span className="planner-number">
          {difference !== "kept" && <span className="visually-hidden">{difference}</span>}
          {difference === "added" && "+"}
          {difference === "removed" ? "−" : index + 1}
        </span>
        <span className="planner-title">{step.title}</span>
        {found.temporal && <span className="planner-time">{timesOf(step)}</span>}
      </button>
      {isOpen && <Why row={row} found={found} onGoTo={onGoTo} />}
    </li>
  );
}

function timesOf({ start, duration }: PlanStep): string {
  return duration === undefined ? short(start) : `${short(start)} – ${short(start + duration)}`;
}

function Why({ row, found, onGoTo }: Pick<StepProps, "row" | "found" | "onGoTo">) {
  const { step, difference } = row;
  const link = (index: number) => (
    <StepLink
      key={index}
      index={index}
      title={found.steps[index]?.title ?? ""}
      onGoTo={difference === "removed" ? null : onGoTo}
    />
  );
  return (
    <dl className="planner-why">
      <dt>Skill</dt>
      <dd>
        <LibraryLink path={step.library}>{step.library}</LibraryLink>
      </dd>
      <dt>Needs</dt>
      {step.needs.length === 0 && <dd className="planner-soft">nothing</dd>}
      {step.needs.map(({ fact, from }) => (
        <dd key={fact}>
          <code>{fact}</code>{" "}
          {from === undefined ? "there from the beginning" : <>by {link(from)}</>}
        </dd>
      ))}
      <dt>Brings</dt>
      {step.brings.length === 0 && <dd className="planner-soft">nothing that is needed</dd>}
      {step.brings.map(({ fact, steps, goal }) => (
        <dd key={fact}>
          <code>{fact}</code> for {goal && <strong>the goal</strong>}
          {goal && steps.length > 0 && ", "}
          {steps.map((each, at) => (
            <span key={each}>
              {at > 0 && ", "}
              {link(each)}
            </span>
          ))}
        </dd>
      ))}
    </dl>
  );
}

interface StepLinkProps {
  readonly index: number;
  readonly title: string;
  readonly onGoTo: ((index: number) => void) | null;
}

function StepLink({ index, title, onGoTo }: StepLinkProps) {
  const text = `${index + 1} ${title}`;
  if (!onGoTo) return <span>{text}</span>;
  return (
    <Button kind="quiet" className="planner-link" onClick={() => onGoTo(index)}>
      {text}
    </Button>
  );
}
