/** Keys of commands as settings have them, for tooltips and menus. */

import { useMemo } from "react";
import { shownKey } from "../commands/keys.ts";
import { useSignal } from "../ui/signals.ts";
import { keysOf } from "./keyboard.ts";
import { useSession } from "./session_context.tsx";

/** The keys of a command. */
export function useKeys(): (id: string) => readonly string[] {
  const session = useSession();
  const map = useSignal(useMemo(() => keysOf(session).byCommand, [session]));
  return (id) => map.get(id) ?? [];
}

/** The first key of a command as it is shown. */
export function useShownKey(): (id: string) => string | undefined {
  const keys = useKeys();
  return (id) => {
    const [key] = keys(id);
    return key === undefined ? undefined : shownKey(key);
  };
}
