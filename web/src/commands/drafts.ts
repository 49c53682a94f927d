/** Texts that were written and not applied yet: saving a machine applies them first. */

import type { Planned } from "../plan/plan.ts";
import { isRefused } from "../plan/plan.ts";
import { setDescription, setScript } from "../plan/states.ts";
import { type Drafts, draftKey, drafts, type FieldDraft } from "../store/document/drafts.ts";
import { wasRefused } from "../store/document/machine_session.ts";
import type { OpenTab, Page } from "../store/page/page.ts";

/** Applies the drafts of a machine. Drafts that cannot be applied remain, and the reason is reported; false if there are any.
 * Drafts of deleted states wait for an undo; the inspector lists them. */
export async function applyDrafts(
  page: Pick<Page, "tell">,
  { session }: Pick<OpenTab, "session">,
  kept: Drafts = drafts,
): Promise<boolean> {
  let isDone = true;
  for (const draft of kept.all.peek().values()) {
    if (draft.machine !== session.id) continue;
    const refusal = await apply(session, draft, kept);
    if (refusal === null) continue;
    isDone = false;
    page.tell({ level: "warning", text: refusal });
  }
  return isDone;
}

async function apply(
  session: OpenTab["session"],
  draft: FieldDraft,
  kept: Drafts,
): Promise<string | null> {
  const { path, field, text, base } = draft;
  const state = session.machine.state(path);
  if (!state) return null;
  const now = (field === "script" ? state.script : state.description) ?? "";
  if (now !== base && now !== text) {
    return `Someone else changed the ${field} of ${state.name}. The inspector keeps your version; compare both there.`;
  }
  if (now !== text) {
    const refusal = await send(session, planOf(draft, session));
    if (refusal !== null) return refusal;
  }
  if (kept.all.peek().get(draftKey(draft))?.text === text) kept.drop(draft);
  return null;
}

function planOf({ path, field, text }: FieldDraft, { machine }: OpenTab["session"]): Planned {
  return field === "script" ? setScript(machine, path, text) : setDescription(machine, path, text);
}

async function send(session: OpenTab["session"], planned: Planned): Promise<string | null> {
  if (isRefused(planned)) return planned.refused;
  const answer = await session.edit(planned.name, planned.edit);
  return wasRefused(answer) ? answer.refused : null;
}
