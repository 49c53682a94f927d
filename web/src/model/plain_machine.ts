/** An immutable machine from a document, for display and comparison. */

import type { Document, StateDocument } from "./generated/protocol.ts";
import type { Machine } from "./machine.ts";
import { parentOf } from "./path.ts";

const NONE: readonly string[] = [];

/** Machine of a document, without the content of its libraries. */
export function machineOf(document: Document): Machine {
  const states = new Map<string, StateDocument>();
  const children = new Map<string, string[]>();
  for (const state of document.states) {
    states.set(state.path, state);
    const parent = parentOf(state.path);
    if (parent === null) continue;
    const siblings = children.get(parent);
    if (siblings) siblings.push(state.path);
    else children.set(parent, [state.path]);
  }
  return {
    version: 0,
    root: document.states[0]?.path ?? "",
    header: document.header,
    state: (path) => states.get(path),
    children: (path) => children.get(path) ?? NONE,
    isInLibrary: () => false,
    paths: () => states.keys(),
  };
}
