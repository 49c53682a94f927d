/** Rules for editable elements, with the reasons of refusals. */

import type { StateDocument, StateKind } from "../model/generated/protocol.ts";
import { isContainer, type Machine } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";
import { isRefused, type Refused, refused } from "./plan.ts";

export const KIND_WORDS: Readonly<Record<StateKind, string>> = {
  execution: "execution state",
  decider: "decider",
  hierarchy: "hierarchy",
  barrier: "barrier concurrency",
  preemptive: "preemptive concurrency",
  library: "library state",
};

/** The state if it may be edited. */
export function stateAt(machine: Machine, path: string): StateDocument | Refused {
  const state = machine.state(path);
  if (!state) {
    return refused(`The state ${path} no longer exists: someone may have removed it.`);
  }
  if (machine.isInLibrary(path)) {
    return refused(`${state.name} belongs to a library: open the library and change it there.`);
  }
  return state;
}

/** The state if states can be put into it. */
export function containerAt(machine: Machine, path: string): StateDocument | Refused {
  const state = stateAt(machine, path);
  if (isRefused(state) || isContainer(state)) return state;
  if (state.kind === "library") {
    return refused(`${state.name} is a library: open it and change its content there.`);
  }
  return refused(
    `${state.name} is ${article(KIND_WORDS[state.kind])} and cannot contain states: make it a hierarchy first.`,
  );
}

/** The state if its own outcomes and ports may be changed. */
export function interfaceAt(machine: Machine, path: string): StateDocument | Refused {
  const state = stateAt(machine, path);
  if (isRefused(state) || state.kind !== "library") return state;
  return refused(
    `${state.name} is a library: its outcomes and ports are those of the library. Change them there.`,
  );
}

/** The path of the container if the state may be taken out of it. */
export function movableFrom(machine: Machine, path: string): string | Refused {
  const state = stateAt(machine, path);
  if (isRefused(state)) return state;
  const parent = parentOf(path);
  if (parent === null) {
    return refused(`${state.name} is the root of the machine: choose states inside it.`);
  }
  if (state.kind === "decider") {
    return refused(`${state.name} is the decider of its barrier and stays there.`);
  }
  return parent;
}

/** The one container that all these states may be taken out of. */
export function commonContainer(machine: Machine, paths: readonly string[]): string | Refused {
  let common: string | null = null;
  for (const path of paths) {
    const parent = movableFrom(machine, path);
    if (typeof parent !== "string") return parent;
    if (common !== null && parent !== common) {
      return refused("The states are in different containers. Choose states of one container.");
    }
    common = parent;
  }
  return common ?? refused("No state is selected: choose one or more states first.");
}

export function article(word: string): string {
  return `${/^[aeiou]/i.test(word) ? "an" : "a"} ${word}`;
}

/** `state`, `1,300 states`. */
export function counted(count: number, word: string): string {
  return count === 1 ? word : `${count.toLocaleString("en")} ${word}s`;
}
