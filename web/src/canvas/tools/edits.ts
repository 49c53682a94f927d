/** Edits inside of edits. */

import type { Edit } from "../../model/generated/protocol.ts";

/** All edits that a batch comes to. */
export function editsOf(edit: Edit): readonly Edit[] {
  return edit.edit === "batch" ? edit.edits.flatMap(editsOf) : [edit];
}
