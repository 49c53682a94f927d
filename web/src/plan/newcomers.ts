/** States that are not there yet: their boxes, and their documents. */

import type { StateDocument, StateKind } from "../model/generated/protocol.ts";
import { type Box, intersects, type Point, type Size } from "../model/geometry.ts";
import { changed, scaledLayout } from "../model/layout.ts";
import { defaultChildBox, readLayout, rootSize } from "../model/layout_reader.ts";
import { ABORTED, type Machine, PREEMPTED } from "../model/machine.ts";
import { freshId, freshName } from "../model/names.ts";
import { childPath, idOf } from "../model/path.ts";
import { childBoxes, inside, lineRoom, sizeIn } from "./boxes.ts";

/** Kinds of states that people add; libraries come by themselves, deciders with their barrier. */
export type NewKind = Exclude<StateKind, "decider" | "library">;

/** Position of a new state: centred at the point, or in the first free space. */
export function newBox(machine: Machine, container: string, at?: Point, aspect = 1): Box {
  const size = sizeIn(machine, container);
  const side = Math.min(size.width, size.height) * 0.2;
  const own = {
    width: aspect >= 1 ? side : side * aspect,
    height: aspect >= 1 ? side / aspect : side,
  };
  if (!at) return { ...freePlace(machine, container, size), ...own };
  const box = { x: at.x - own.width / 2, y: at.y - own.height / 2, ...own };
  return inside(box, size, lineRoom(size));
}

const PLACES = 256;

function freePlace(machine: Machine, container: string, size: Size): Point {
  const taken = [...childBoxes(machine, container).values()];
  for (let index = 0; index < PLACES; index++) {
    const box = defaultChildBox(index, size);
    if (!taken.some((other) => intersects(box, other))) return box;
  }
  return defaultChildBox(taken.length, size);
}

/** An id that no child of the container has, nor the container itself. */
export function newId(machine: Machine, container: string, also: Iterable<string> = []): string {
  const taken = new Set([...machine.children(container).map(idOf), idOf(container), ...also]);
  return freshId((id) => taken.has(id) || machine.state(childPath(container, id)) !== undefined);
}

/** `State`, `State 2`, …: a name that no sibling has. */
export function newName(machine: Machine, container: string, base: string): string {
  const names = new Set(machine.children(container).map((path) => machine.state(path)?.name));
  let name = base;
  for (let number = 2; names.has(name); number++) name = `${base} ${number}`;
  return name;
}

const SCRIPT = `def execute(self, inputs, outputs, gvm):
    return "success"
`;

const NAMES: Readonly<Record<NewKind, string>> = {
  execution: "State",
  hierarchy: "Hierarchy",
  barrier: "Barrier",
  preemptive: "Preemptive",
};

export function newState(
  machine: Machine,
  container: string,
  kind: NewKind,
  box: Box,
  name?: string,
): StateDocument {
  return {
    path: newId(machine, container),
    name: name ?? newName(machine, container, NAMES[kind]),
    kind,
    outcomes: [
      { id: PREEMPTED, name: "preempted" },
      { id: ABORTED, name: "aborted" },
      { id: 0, name: "success" },
    ],
    ...(kind === "execution" ? { script: SCRIPT } : {}),
    layout: changed(null, { position: box, size: box }),
  };
}

/** A library as it is named by states that run it. */
export interface LibraryToInsert {
  readonly path: string;
  readonly name: string;
  readonly version?: string | null;
}

/** A new state that runs a library, in the library's own form. */
export function newLibrary(
  machine: Machine,
  container: string,
  library: LibraryToInsert,
  root: StateDocument,
  at?: Point,
): StateDocument {
  const size = rootSize(root);
  const box = newBox(machine, container, at, size.width / size.height);
  const name = libraryStateName(machine, container, root);
  return libraryState(newId(machine, container), name, library, root, box);
}

/** A library state under an id; its box has the form of the library. */
export function libraryState(
  id: string,
  name: string,
  library: LibraryToInsert,
  root: StateDocument,
  box: Box,
): StateDocument {
  const { version } = library;
  return {
    path: id,
    name,
    kind: "library",
    ...(root.outcomes ? { outcomes: root.outcomes } : {}),
    ...(root.inputs ? { inputs: root.inputs } : {}),
    ...(root.outputs ? { outputs: root.outputs } : {}),
    layout: libraryLayout(root, box),
    library: { path: library.path, name: library.name, ...(version ? { version } : {}) },
  };
}

/** Only what shows of a library from outside: its ports where the library has them. */
function libraryLayout(root: StateDocument, box: Box) {
  const size = rootSize(root);
  const { ports, nameBox } = readLayout(root);
  const factor = { x: box.width / size.width, y: box.height / size.height };
  const outside = [...ports].filter(([key]) => /^(income|outcome|input_|output_)/.test(key));
  const bare = changed(null, { ports: new Map(outside), nameBox });
  return scaledLayout({ ...root, layout: bare }, box, factor);
}

/** The name of a library's root as that of a new sibling. */
function libraryStateName(machine: Machine, container: string, root: StateDocument): string {
  const names = machine.children(container).flatMap((path) => machine.state(path)?.name ?? []);
  return freshName(root.name, names);
}
