/** What an edit will do, before the server has said so. Only what is sure is foretold: rules are the server's. */

import type { Edit } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { children } from "./children.ts";
import { connections } from "./connections.ts";
import { Draft, type Write } from "./draft.ts";
import { ownInterface } from "./interface.ts";
import { moved } from "./moved.ts";
import { own } from "./own.ts";
import { places } from "./places.ts";

/** The writes that the edit comes to; null if only the server knows. */
export function foretell(machine: Machine, edit: Edit): readonly Write[] | null {
  const draft = new Draft(machine);
  return write(draft, edit) ? draft.writes : null;
}

const KINDS = [own, ownInterface, connections, places, children, moved];

function write(draft: Draft, edit: Edit): boolean {
  if (edit.edit === "batch") return edit.edits.every((each) => write(draft, each));
  return KINDS.some((kind) => kind(draft, edit));
}
