/** Foretells edits of a state itself. */

import type { Edit, StateDocument } from "../../model/generated/protocol.ts";
import type { Draft } from "./draft.ts";

/** Writes what the edit does; false if only the server knows. */
export function own(draft: Draft, edit: Edit): boolean {
  switch (edit.edit) {
    case "set_name":
      return set(draft, edit.path, { name: edit.name });
    default:
      return false;
  }
}

function set(draft: Draft, path: string, fields: Partial<StateDocument>): boolean {
  const state = draft.state(path);
  if (!state) return false;
  draft.put({ ...state, ...fields });
  return true;
}
