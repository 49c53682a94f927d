/** Moves drafts along with their states: to another id or container, into a group, out of one, and back by an undo. */

import type { StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { idOf } from "../../model/path.ts";
import type { Drafts, FieldDraft } from "./drafts.ts";
import type { MachineSession } from "./machine_session.ts";

/** Listens until the returned function is called. */
export function followDrafts(
  session: Pick<MachineSession, "id" | "machine" | "onChange">,
  kept: Drafts,
): () => void {
  const { id, machine } = session;
  let known = new Set(machine.paths());
  return session.onChange((touched) => {
    const before = known;
    const paths = [...(touched ?? machine.paths())];
    const came = paths.filter((path) => !before.has(path) && machine.state(path));
    const gone = [...kept.all.peek().values()].filter(
      ({ machine: whose, path }) => whose === id && !machine.state(path),
    );
    const hasJustGone = new Set(gone.map(({ path }) => path).filter((path) => before.has(path)));
    known = renewed(before, touched, machine);
    for (const draft of gone) {
      const now = placeOf(draft, machine, came, hasJustGone.has(draft.path));
      if (now !== null && !kept.get({ ...draft, path: now })) kept.move(id, draft.path, now);
    }
  });
}

function renewed(
  known: Set<string>,
  touched: ReadonlySet<string> | null,
  machine: Machine,
): Set<string> {
  if (touched === null) return new Set(machine.paths());
  for (const path of touched) {
    if (machine.state(path)) known.add(path);
    else known.delete(path);
  }
  return known;
}

/** New path of a draft's state: the only new state with its id and text. If the state has just disappeared, a new state that only
 * has its text also qualifies. Null without exactly one match. */
function placeOf(
  draft: FieldDraft,
  machine: Machine,
  came: readonly string[],
  hasJustGone: boolean,
): string | null {
  const found = came.filter((path) => {
    const state = machine.state(path);
    return state !== undefined && textOf(state, draft) === draft.base;
  });
  const same = found.filter((path) => idOf(path) === idOf(draft.path));
  const [only, ...more] = same.length > 0 || !hasJustGone ? same : found;
  return only !== undefined && more.length === 0 ? only : null;
}

function textOf(state: StateDocument, { field }: FieldDraft): string | null {
  if (field === "description") return state.description ?? "";
  const hasScript = state.kind === "execution" || state.kind === "decider";
  return hasScript ? (state.script ?? "") : null;
}
