/** Commands as entries of menus. */

import { type CommandMenuEntry, entryOf } from "../commands/menus.ts";
import type { CommandId } from "../store/page/command_arguments.ts";
import { useKeys } from "./keys_shown.ts";
import { useSession } from "./session_context.tsx";

/** Commands as entries of a menu, as they are when it opens. */
export function useEntries(ids: readonly CommandId[]): () => readonly CommandMenuEntry[] {
  const { commands, context } = useSession();
  const keys = useKeys();
  return () =>
    ids.flatMap((id) => {
      const command = commands.get(id);
      return command ? [entryOf({ commands, context: context(), keys }, command)] : [];
    });
}
