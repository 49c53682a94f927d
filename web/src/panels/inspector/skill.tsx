/** Planner annotation of a state. It makes the library with this state a skill for planning engines. */

import { Plus, Trash2 } from "lucide-react";
import {
  firstNotes,
  type SkillNotes,
  skillNotes,
  withoutSkillNotes,
  withSkillNotes,
} from "../../model/skill.ts";
import { setSemanticData } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { IconButton } from "../../ui/button.tsx";
import { onDemand } from "../../ui/on_demand.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

const SkillForm = onDemand(async () => (await import("./skill_form.tsx")).SkillForm);

export function Skill({ inspected }: { inspected: InspectedState }) {
  const { path, state, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const notes = skillNotes(state.semantic_data);
  const put = (changed: Partial<SkillNotes>): Made =>
    edit((now) =>
      setSemanticData(now, path, withSkillNotes(now.state(path)?.semantic_data, changed)),
    );
  const remove = () =>
    run(
      edit((now) => setSemanticData(now, path, withoutSkillNotes(now.state(path)?.semantic_data))),
    );
  const actions = !readOnly && (
    <IconButton
      label={notes ? "Remove the planner annotation" : "Add a planner annotation"}
      icon={notes ? <Trash2 size={14} /> : <Plus size={15} />}
      onClick={() => (notes ? remove() : run(put(firstNotes(state))))}
    />
  );
  return (
    <Fold title="Planner" openAtFirst={notes !== null} actions={actions}>
      {notes ? (
        <SkillForm key={path} inspected={inspected} notes={notes} put={put} />
      ) : (
        <p className="inspector-none">
          No action (what the state does, in the words of planners; it makes a library a skill).
        </p>
      )}
      <Refusal text={refusal} />
    </Fold>
  );
}
