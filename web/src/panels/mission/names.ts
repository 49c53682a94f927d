/** Readable paths of states, with names from the active machine as far as they are known. */

import { signal } from "@preact/signals-core";
import { namesTo } from "../../model/machine.ts";
import { idOf, lineage } from "../../model/path.ts";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab } from "../context.tsx";

/** Names of the states from the root to a path. */
export type Names = (path: string) => readonly string[];

const NEVER = signal(0);

export function useMachineNames(): Names {
  const tab = useActiveTab();
  useSignal(tab?.session.version ?? NEVER);
  return (path) => (tab ? namesTo(tab.session.machine, path) : lineage(path).map(idOf));
}

/** Path to a state without the root, which is the mission: `Assemble › Find object`. */
export function pathInWords(names: Names, path: string): string {
  const all = names(path).map((name) => name.slice(name.lastIndexOf("/") + 1));
  return (all.length > 1 ? all.slice(1) : all).join(" › ");
}
