/** What every panel is given: the page, the machine in front, the commands. */

import { createContext, useContext, useDeferredValue } from "react";
import type { CommandContext, Commands } from "../commands/command.ts";
import type { OpenTab } from "../store/page/page.ts";
import { useComputed, useSignal } from "../ui/signals.ts";

export interface PanelHost {
  readonly commands: Commands;
  /** What commands may use now. */
  readonly context: () => CommandContext;
}

const Host = createContext<PanelHost | null>(null);

export const PanelHostProvider = Host.Provider;

export function useHost(): PanelHost {
  const host = useContext(Host);
  if (!host) throw new Error("a panel stands outside of the page");
  return host;
}

/** The machine in front; null if none is open. The canvas shows another one first, and panels follow without holding it up. */
export function useActiveTab(): OpenTab | null {
  return useDeferredValue(useSignal(useHost().context().page.active));
}

/** Runs a command by its name. */
export function useCommand(): (id: string, argument?: unknown) => void {
  const host = useHost();
  return (id, argument) => void host.commands.run(id, host.context(), argument);
}

/** Why a command cannot be run now, drawn again when that changes; null if it can. */
export function useRefusalOf(id: string): string | null {
  const { commands, context } = useHost();
  return useComputed(() => commands.refusalOf(id, context()), [commands, context, id]);
}
