/** Nested edits. */

import type { Edit } from "../../model/generated/protocol.ts";

/** All edits of a batch, flattened. */
export function editsOf(edit: Edit): readonly Edit[] {
  return edit.edit === "batch" ? edit.edits.flatMap(editsOf) : [edit];
}
