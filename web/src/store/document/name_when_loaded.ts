/** Names of states that may be inside a library. Loads the content of libraries as needed. */

import type { Machine } from "../../model/machine.ts";
import { idOf, lineage } from "../../model/path.ts";
import type { MachineSession } from "./machine_session.ts";

/** Name of a state, or its id if the machine does not have it after all libraries around it are loaded. */
export async function nameWhenLoaded(
  session: {
    readonly machine: Pick<Machine, "state">;
    readonly loadLibrary: MachineSession["loadLibrary"];
  },
  path: string,
): Promise<string> {
  const { machine } = session;
  const asked = new Set<string>();
  for (;;) {
    const state = machine.state(path);
    if (state) return state.name;
    const library = lineage(path).findLast((outer) => machine.state(outer)?.kind === "library");
    if (library === undefined || asked.has(library)) return idOf(path);
    asked.add(library);
    await session.loadLibrary(library);
  }
}
