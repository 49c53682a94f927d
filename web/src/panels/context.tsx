/** Context of all panels: the page, the active machine, and the commands. */

import { createContext, useContext, useDeferredValue } from "react";
import type { CommandContext, Commands } from "../commands/command.ts";
import type { ArgumentOf, CommandId } from "../store/page/command_arguments.ts";
import type { OpenTab } from "../store/page/page.ts";
import { useComputed, useSignal } from "../ui/signals.ts";

export interface PanelHost {
  readonly commands: Commands;
  /** Current context of commands. */
  readonly context: () => CommandContext;
}

/** Runs a command by its id. */
export type RunCommand = <Id extends CommandId>(id: Id, ...argument: ArgumentOf<Id>) => void;

const Host = createContext<PanelHost | null>(null);

export const PanelHostProvider = Host.Provider;

export function useHost(): PanelHost {
  const host = useContext(Host);
  if (!host) throw new Error("a panel is rendered outside of PanelHostProvider");
  return host;
}

/** Active machine; null if none is open. Its value is deferred, so that the canvas switches without waiting for the panels. */
export function useActiveTab(): OpenTab | null {
  return useDeferredValue(useSignal(useHost().context().page.active));
}

/** Returns a function that runs a command by its id. */
export function useCommand(): RunCommand {
  const host = useHost();
  return (id, ...argument) => void host.commands.run(id, host.context(), ...argument);
}

/** Reason why a command is unavailable; null if it is available. Components render again when it changes. */
export function useRefusalOf(id: CommandId): string | null {
  const { commands, context } = useHost();
  return useComputed(() => commands.refusalOf(id, context()), [commands, context, id]);
}
