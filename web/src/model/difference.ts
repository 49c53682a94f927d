/** Differences between two machines, in words: added, removed and changed states, ports, outcomes, connections and values. */

import { pairConnections } from "./connection_pairs.ts";
import type { ElementKey, ElementRef } from "./element.ts";
import { keyOf } from "./element.ts";
import { connectionInWords } from "./ends.ts";
import type { OutcomeDocument, PortDocument, StateDocument } from "./generated/protocol.ts";
import { isSame } from "./json.ts";
import {
  dataFlowsOf,
  type Machine,
  outcomesOf,
  type PortKind,
  portsOf,
  transitionsOf,
} from "./machine.ts";
import { pairStates, type StatePairs } from "./pairs.ts";
import { idOf, parentOf } from "./path.ts";
import { type FieldChange, stateFields } from "./state_fields.ts";
import { python } from "./value.ts";

export interface Difference {
  readonly kind: "added" | "removed" | "changed";
  /** Current element; for a removed one, its former path. */
  readonly element: ElementRef;
  /** Name in words. */
  readonly name: string;
  readonly fields: readonly FieldChange[];
  /** Number of states inside it that were added or removed with it. */
  readonly inside: number;
  /** True if only its layout differs. */
  readonly isLayout: boolean;
}

/** Changes from the old machine to the current one, in the order of the current one. Removed states are listed at their container. */
export function differences(old: Machine, now: Machine): readonly Difference[] {
  const comparison = { old, now, pairs: pairStates(old, now) };
  const found: Difference[] = [...header(comparison)];
  for (const path of now.paths()) {
    const state = now.state(path);
    const before = old.state(comparison.pairs.oldOf.get(path) ?? "");
    if (!state) continue;
    if (!before) found.push(...addedState(comparison, state));
    else if (!isSame(state, before)) found.push(...changedState(comparison, before, state));
    if (before) found.push(...goneChildren(comparison, before.path));
  }
  return found;
}

/** Differences by element. An added state includes everything inside it; a removed element keeps its former path. */
export function marksOf(
  all: readonly Difference[],
  now: Machine,
): ReadonlyMap<ElementKey, Difference["kind"]> {
  const marks = new Map<ElementKey, Difference["kind"]>();
  for (const { kind, element, isLayout } of all) {
    if (isLayout) continue;
    marks.set(keyOf(element), kind);
    if (kind === "added" && element.kind === "state") {
      for (const inner of inside(now, element.path)) {
        marks.set(keyOf({ kind: "state", path: inner }), kind);
      }
    }
  }
  return marks;
}

interface MachinePair {
  readonly old: Machine;
  readonly now: Machine;
  readonly pairs: StatePairs;
}

const NOTHING = { fields: [], inside: 0, isLayout: false } as const;

function header({ old, now }: MachinePair): readonly Difference[] {
  const [before, after] = [old.header.version ?? "", now.header.version ?? ""];
  if (before === after) return [];
  const fields = [{ field: "version of the machine", old: before, now: after, isText: false }];
  const element: ElementRef = { kind: "state", path: now.root };
  const name = now.state(now.root)?.name ?? now.root;
  return [{ ...NOTHING, kind: "changed", element, name, fields }];
}

function addedState({ now, pairs }: MachinePair, state: StateDocument): readonly Difference[] {
  const parent = parentOf(state.path);
  if (parent !== null && !pairs.oldOf.has(parent)) return [];
  return [wholeState("added", now, state)];
}

function goneChildren({ old, pairs }: MachinePair, path: string): readonly Difference[] {
  return old.children(path).flatMap((child) => {
    const state = old.state(child);
    return state && !pairs.newOf.has(child) ? [wholeState("removed", old, state)] : [];
  });
}

function wholeState(kind: "added" | "removed", machine: Machine, state: StateDocument): Difference {
  const element: ElementRef = { kind: "state", path: state.path };
  const count = inside(machine, state.path).length;
  return { ...NOTHING, kind, element, name: state.name, inside: count };
}

function inside(machine: Machine, path: string): readonly string[] {
  const found: string[] = [];
  const open = [...machine.children(path)];
  for (let next = open.pop(); next !== undefined; next = open.pop()) {
    if (machine.isInLibrary(next)) continue;
    found.push(next);
    open.push(...machine.children(next));
  }
  return found;
}

function changedState(
  comparison: MachinePair,
  before: StateDocument,
  state: StateDocument,
): readonly Difference[] {
  const element: ElementRef = { kind: "state", path: state.path };
  const fields = [...place(comparison, before, state), ...stateFields(before, state)];
  const parts = [
    ...outcomes(before, state),
    ...ports(before, state),
    ...connections(comparison, before, state),
  ];
  const isMoved = !isSame(before.layout ?? null, state.layout ?? null);
  const name = state.name;
  if (fields.length > 0) return [{ ...NOTHING, kind: "changed", element, name, fields }, ...parts];
  if (!isMoved || parts.length > 0) return parts;
  return [{ ...NOTHING, kind: "changed", element, name, isLayout: true }];
}

/** Changes of the id and of the container. */
function place(
  { pairs }: MachinePair,
  before: StateDocument,
  state: StateDocument,
): readonly FieldChange[] {
  const field = (name: string, old: string, now: string) =>
    old === now ? [] : [{ field: name, old, now, isText: false }];
  const [from, to] = [parentOf(before.path), parentOf(state.path)];
  const sameParent = from === null || to === null || pairs.newOf.get(from) === to;
  return [
    ...field("id", idOf(before.path), idOf(state.path)),
    ...(sameParent ? [] : field("container", from ?? "", to ?? "")),
  ];
}

interface NamedPart {
  readonly id: number;
  readonly name: string;
}

/** Added, removed and changed parts of a list with ids. */
function parts<T extends NamedPart>(
  [before, after]: readonly [readonly T[], readonly T[]],
  ref: (part: T, kind: Difference["kind"]) => ElementRef,
  fieldsOf: (old: T, now: T) => readonly FieldChange[],
): readonly Difference[] {
  const old = new Map(before.map((part) => [part.id, part]));
  const found = after.flatMap((part): Difference[] => {
    const earlier = old.get(part.id);
    old.delete(part.id);
    const { name } = part;
    if (!earlier) return [{ ...NOTHING, kind: "added", element: ref(part, "added"), name }];
    const fields = fieldsOf(earlier, part);
    if (fields.length === 0) return [];
    return [{ ...NOTHING, kind: "changed", element: ref(part, "changed"), name, fields }];
  });
  const gone = [...old.values()].map((part): Difference => {
    return { ...NOTHING, kind: "removed", element: ref(part, "removed"), name: part.name };
  });
  return [...found, ...gone];
}

function text(field: string, old: string, now: string): readonly FieldChange[] {
  return old === now ? [] : [{ field, old, now, isText: false }];
}

function outcomes(before: StateDocument, state: StateDocument): readonly Difference[] {
  return parts<OutcomeDocument>(
    [outcomesOf(before), outcomesOf(state)],
    ({ id }) => ({ kind: "outcome", path: state.path, id }),
    (old, now) => text("name", old.name, now.name),
  );
}

const KINDS: readonly PortKind[] = ["input", "output", "scoped_variable"];

function ports(before: StateDocument, state: StateDocument): readonly Difference[] {
  return KINDS.flatMap((kind) =>
    parts<PortDocument>(
      [portsOf(before, kind), portsOf(state, kind)],
      ({ id }) => ({ kind, path: state.path, id }),
      (old, now) => [
        ...text("name", old.name, now.name),
        ...text("type", old.data_type, now.data_type),
        ...text("default", python(old.default), python(now.default)),
      ],
    ),
  );
}

function connections(
  { old, now, pairs }: MachinePair,
  before: StateDocument,
  state: StateDocument,
): readonly Difference[] {
  const idNow = (id: string) =>
    id === idOf(before.path)
      ? idOf(state.path)
      : idOf(pairs.newOf.get(`${before.path}/${id}`) ?? id);
  const lists = [
    ["transition", transitionsOf(before), transitionsOf(state)],
    ["data_flow", dataFlowsOf(before), dataFlowsOf(state)],
  ] as const;
  return lists.flatMap(([kind, earlier, later]) =>
    pairConnections(earlier, later, idNow).map(({ old: from, now: to }): Difference => {
      const was = from && connectionInWords(old, { kind, path: before.path, id: from.id });
      const is = to && connectionInWords(now, { kind, path: state.path, id: to.id });
      const id = (to ?? from)?.id ?? 0;
      const element: ElementRef = { kind, path: to ? state.path : before.path, id };
      const fields = was && is ? text("way", was, is) : [];
      const change = was && is ? "changed" : is ? "added" : "removed";
      return { ...NOTHING, kind: change, element, name: is ?? was ?? "", fields };
    }),
  );
}
