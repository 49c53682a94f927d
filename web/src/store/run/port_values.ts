/** Values at ports at the shown moment: inputs and variables of active states, outputs of states that ended inside them. */

import { type ElementKey, keyOf } from "../../model/element.ts";
import type { Moment } from "../../model/generated/protocol.ts";
import { type Machine, type PortKind, portsOf } from "../../model/machine.ts";

/** Values of the picture by the key of their port. */
export function portValues(picture: Moment, machine: Machine): ReadonlyMap<ElementKey, unknown> {
  const found = new Map<ElementKey, unknown>();
  const put = (path: string, kind: PortKind, values: Readonly<Record<string, unknown>> | null) => {
    const state = values && machine.state(path);
    if (!state) return;
    for (const { id, name } of portsOf(state, kind)) {
      if (Object.hasOwn(values, name)) found.set(keyOf({ kind, path, id }), values[name]);
    }
  };
  for (const { path, inputs, scoped, ended } of picture.active) {
    put(path, "input", inputs);
    put(path, "scoped_variable", scoped);
    for (const end of ended) put(end.path, "output", end.outputs);
  }
  return found;
}
