/** Fields of a planner annotation, with completion and checks. */

import { TriangleAlert } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import {
  faultsOfAction,
  filledIn,
  REQUIREMENTS,
  type SkillNotes,
  skillFaults,
  wordsOfNotes,
} from "../../model/skill.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { knownWords } from "../../store/planner/planner.ts";
import { Button } from "../../ui/button.tsx";
import { Checkbox, TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { PddlField } from "../parts/pddl_field.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

interface SkillFormProps {
  readonly inspected: InspectedState;
  readonly notes: SkillNotes;
  readonly put: (changed: Partial<SkillNotes>) => Made;
}

export function SkillForm({ inspected, notes, put }: SkillFormProps) {
  const { state, readOnly } = inspected;
  const [refusal, run] = useRefusal();
  const faults = useMemo(() => skillFaults(notes, state), [notes, state]);
  const missing = useMemo(() => filledIn(notes), [notes]);
  return (
    <div className="inspector-fields">
      <Action
        notes={notes}
        readOnly={readOnly}
        onApply={(text) => run(put({ pddl_action: text }))}
      />
      {faults.length > 0 && (
        <ul className="inspector-skill-faults" aria-label="Skill problems">
          {faults.map((fault) => (
            <li key={fault}>
              <TriangleAlert size={13} aria-hidden />
              <span>{fault}</span>
            </li>
          ))}
        </ul>
      )}
      {missing && !readOnly && (
        <Button onClick={() => run(put(missing))}>Fill in predicates and types</Button>
      )}
      <TextField
        label="Predicates"
        multiline
        mono
        readOnly={readOnly}
        value={notes.pddl_predicates}
        onCommit={(text) => put({ pddl_predicates: text })}
      />
      <TextField
        label="Types"
        mono
        readOnly={readOnly}
        value={notes.pddl_types}
        hint="With commas; a kind of another: Cup - Thing."
        onCommit={(text) => put({ pddl_types: text })}
      />
      <TextField
        label="Numbers"
        mono
        readOnly={readOnly}
        value={notes.pddl_functions}
        placeholder="(battery ?rover - Rover)"
        onCommit={(text) => put({ pddl_functions: text })}
      />
      <TextField
        label="Description"
        readOnly={readOnly}
        value={notes.description}
        onCommit={(description) => put({ description })}
      />
      <Requirements
        notes={notes}
        readOnly={readOnly}
        onChange={(requirements) => run(put({ requirements }))}
      />
      <Refusal text={refusal} />
    </div>
  );
}

interface ActionProps {
  readonly notes: SkillNotes;
  readonly readOnly: boolean;
  readonly onApply: (text: string) => void;
}

/** Editor of the action. Ctrl+Enter and loss of focus apply it. */
function Action({ notes, readOnly, onApply }: ActionProps) {
  const known = useSignal(knownWords);
  const [typed, setTyped] = useState<string | null>(null);
  const text = typed ?? notes.pddl_action;
  const words = useMemo(
    () => wordsOfNotes({ ...notes, pddl_action: text }, known),
    [notes, text, known],
  );
  // biome-ignore lint/correctness/useExhaustiveDependencies: the typed text is kept until the machine's text changes
  useEffect(() => setTyped(null), [notes.pddl_action]);
  const apply = () => {
    if (typed !== null && typed !== notes.pddl_action) onApply(typed);
  };
  return (
    <div className="field">
      <span className="field-label">Action</span>
      <PddlField
        label="Action"
        example="(:action name :parameters (?x - type) …)"
        value={text}
        readOnly={readOnly}
        words={words}
        faults={faultsOfAction}
        onChange={setTyped}
        onApply={apply}
        onLeave={apply}
      />
    </div>
  );
}

interface RequirementsProps {
  readonly notes: SkillNotes;
  readonly readOnly: boolean;
  readonly onChange: (requirements: readonly string[]) => void;
}

function Requirements({ notes: { requirements }, readOnly, onChange }: RequirementsProps) {
  const others = requirements.filter((each) => !(REQUIREMENTS as readonly string[]).includes(each));
  const toggle = (name: string, isOn: boolean) =>
    onChange(isOn ? [...requirements, name] : requirements.filter((each) => each !== name));
  return (
    <details>
      <summary className="inspector-skill-summary">
        Requirements: {requirements.length === 0 ? "none" : requirements.join(" ")}
      </summary>
      {[...REQUIREMENTS, ...others].map((name) => (
        <Checkbox
          key={name}
          label={name}
          checked={requirements.includes(name)}
          disabled={readOnly}
          onChange={(isOn) => toggle(name, isOn)}
        />
      ))}
    </details>
  );
}
