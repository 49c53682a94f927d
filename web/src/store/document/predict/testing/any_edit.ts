/** Random edits of all predicted kinds, for tests: most of them valid, some not. */

import type { Edit, Goal, PortList, StateDocument } from "../../../../model/generated/protocol.ts";
import {
  dataFlowsOf,
  isContainer as holdsStates,
  type Machine,
  outcomesOf,
  type PortKind,
  portsOf,
  transitionsOf,
} from "../../../../model/machine.ts";
import { idOf, parentOf } from "../../../../model/path.ts";

/** Picks a number from 0 to below the bound. */
export type Pick = (bound: number) => number;

type Maker = (state: StateDocument, machine: Machine, pick: Pick) => Edit;

/** An edit of a random state of the machine. */
export function anyEdit(machine: Machine, pick: Pick): Edit {
  const state = one([...machine.paths()], pick);
  const document = state === undefined ? undefined : machine.state(state);
  const maker = one(MAKERS, pick);
  if (!document || !maker) throw new Error("a machine without states");
  if (pick(12) === 0) {
    const edits = [maker(document, machine, pick), one(MAKERS, pick)?.(document, machine, pick)];
    return { edit: "batch", edits: edits.flatMap((edit) => edit ?? []) };
  }
  return maker(document, machine, pick);
}

function one<T>(list: readonly T[], pick: Pick): T | undefined {
  return list[pick(Math.max(1, list.length))];
}

function id(list: readonly { readonly id: number }[], pick: Pick): number {
  return one(list, pick)?.id ?? pick(3);
}

const LISTS: readonly PortList[] = ["input", "output", "scoped_variable"];

function place(state: StateDocument, pick: Pick) {
  const list = one(LISTS, pick) ?? "input";
  return { path: state.path, list, port: id(portsOf(state, list), pick) };
}

function freshPort(state: StateDocument): number {
  const kinds: readonly PortKind[] = ["input", "output", "scoped_variable"];
  const taken = kinds.flatMap((kind) => portsOf(state, kind).map((port) => port.id));
  return Math.max(-1, ...taken) + 1;
}

function goal(state: StateDocument, machine: Machine, pick: Pick): Goal {
  const child = one(machine.children(state.path), pick);
  if (child && pick(3) > 0) return { state: idOf(child) };
  return { outcome: id(outcomesOf(state), pick) };
}

function from(state: StateDocument, machine: Machine, pick: Pick) {
  const child = machine.state(one(machine.children(state.path), pick) ?? "");
  return child ? { state: idOf(child.path), outcome: id(outcomesOf(child), pick) } : null;
}

function end(state: StateDocument, machine: Machine, pick: Pick) {
  const children = [state.path, ...machine.children(state.path)];
  const owner = machine.state(one(children, pick) ?? "") ?? state;
  return { state: idOf(owner.path), port: id(portsOf(owner, one(LISTS, pick) ?? "input"), pick) };
}

function next(list: readonly { readonly id: number }[]): number {
  return Math.max(0, ...list.map((each) => each.id)) + 1;
}

/** The state, with a sibling or without. */
function someIds(machine: Machine, path: string, pick: Pick): string[] {
  const sibling = one(machine.children(parentOf(path) ?? path), pick);
  return [...new Set([path, ...(sibling && pick(2) > 0 ? [sibling] : [])])].map(idOf);
}

function name(pick: Pick): string {
  return `name${pick(1000)}`;
}

function point(pick: Pick): [number, number] {
  return [pick(400), pick(300) + 0.5];
}

const KINDS = ["execution", "hierarchy", "barrier", "preemptive"] as const;

const MAKERS: readonly Maker[] = [
  ({ path }, _, pick) => ({ edit: "set_name", path, name: name(pick) }),
  ({ path }, _, pick) => ({
    edit: "set_description",
    path,
    description: pick(3) > 0 ? name(pick) : pick(2) > 0 ? "" : null,
  }),
  ({ path }, _, pick) => ({ edit: "set_script", path, script: pick(4) > 0 ? name(pick) : null }),
  ({ path }, _, pick) => ({
    edit: "set_semantic_data",
    path,
    semantic_data: pick(3) > 0 ? { note: name(pick) } : null,
  }),
  (state, _, pick) => ({
    edit: "add_outcome",
    path: state.path,
    outcome: next(outcomesOf(state)) - 1,
    name: name(pick),
  }),
  (state, _, pick) => ({
    edit: "rename_outcome",
    path: state.path,
    outcome: id(outcomesOf(state), pick),
    name: name(pick),
  }),
  (state, _, pick) => ({
    edit: "remove_outcome",
    path: state.path,
    outcome: id(outcomesOf(state), pick),
  }),
  (state, _, pick) => ({
    edit: "add_port",
    path: state.path,
    list: one(LISTS, pick) ?? "input",
    port: freshPort(state),
    name: name(pick),
    data_type: "int",
    default: pick(2) > 0 ? pick(9) : null,
  }),
  (state, _, pick) => ({ edit: "rename_port", ...place(state, pick), name: name(pick) }),
  (state, _, pick) => ({
    edit: "set_port_type",
    ...place(state, pick),
    data_type: one(["int", "float", "str", "object"], pick) ?? "int",
  }),
  (state, _, pick) => ({
    edit: "set_port_default",
    ...place(state, pick),
    default: one([null, 4, 2.5, "text", [1, 2], { a: 1 }], pick) ?? null,
  }),
  (state, _, pick) => ({ edit: "remove_port", ...place(state, pick) }),
  (state, machine, pick) => ({
    edit: "add_transition",
    path: state.path,
    transition: next(transitionsOf(state)),
    from: from(state, machine, pick),
    to: goal(state, machine, pick),
  }),
  (state, machine, pick) => ({
    edit: "set_transition_origin",
    path: state.path,
    transition: id(transitionsOf(state), pick),
    from: from(state, machine, pick),
  }),
  (state, machine, pick) => ({
    edit: "set_transition_target",
    path: state.path,
    transition: id(transitionsOf(state), pick),
    to: goal(state, machine, pick),
  }),
  (state, _, pick) => ({
    edit: "remove_transition",
    path: state.path,
    transition: id(transitionsOf(state), pick),
  }),
  (state, machine, pick) => ({
    edit: "set_start",
    path: state.path,
    to: pick(3) > 0 ? goal(state, machine, pick) : null,
  }),
  (state, machine, pick) => ({
    edit: "add_data_flow",
    path: state.path,
    data_flow: next(dataFlowsOf(state)),
    from: end(state, machine, pick),
    to: end(state, machine, pick),
  }),
  (state, machine, pick) => ({
    edit: "set_data_flow_source",
    path: state.path,
    data_flow: id(dataFlowsOf(state), pick),
    from: end(state, machine, pick),
  }),
  (state, machine, pick) => ({
    edit: "set_data_flow_target",
    path: state.path,
    data_flow: id(dataFlowsOf(state), pick),
    to: end(state, machine, pick),
  }),
  (state, _, pick) => ({
    edit: "remove_data_flow",
    path: state.path,
    data_flow: id(dataFlowsOf(state), pick),
  }),
  (state, _, pick) => ({
    edit: "set_position",
    path: state.path,
    element:
      one(["state", "name", "income", { outcome: id(outcomesOf(state), pick) }] as const, pick) ??
      "state",
    position: point(pick),
  }),
  ({ path }, _, pick) => ({ edit: "set_size", path, element: "state", size: point(pick) }),
  (state, _, pick) => ({
    edit: "set_waypoints",
    path: state.path,
    element: { transition: id(transitionsOf(state), pick) },
    waypoints: [point(pick), point(pick)],
  }),
  ({ path }, _, pick) => ({
    edit: "set_layout",
    path,
    layout: pick(4) > 0 ? { gui: { show_content: true }, own: pick(9) } : null,
  }),
  ({ path }, _, pick) => ({
    edit: "add_state",
    path,
    states: [{ path: `NEW${pick(30)}`, name: name(pick), kind: one(KINDS, pick) ?? "execution" }],
  }),
  ({ path }, _, pick) => ({
    edit: "add_state",
    path,
    states: [
      { path: "IN", name: name(pick), kind: "hierarchy", outcomes: [{ id: 0, name: "success" }] },
      { path: "IN/A", name: "A", kind: "execution" },
    ],
  }),
  ({ path }, machine, pick) => ({
    edit: "move_states",
    path: parentOf(path) ?? machine.root,
    states: someIds(machine, path, pick),
    to: one([...machine.paths()], pick) ?? machine.root,
    ids: pick(2) > 0 ? [] : [`MOVED${pick(30)}`],
  }),
  ({ path }, machine, pick) => ({
    edit: "paste",
    path,
    selection: {
      container: machine.root,
      states: machine
        .children(machine.root)
        .slice(0, 2)
        .flatMap((child) => machine.state(child) ?? [])
        .filter((state) => !holdsStates(state) && !state.library)
        .map((state) => ({ ...state, path: idOf(state.path) })),
    },
    ids: [`COPY${pick(99)}`, `COPY${100 + pick(99)}`],
  }),
  ({ path }, _, pick) => ({
    edit: "set_id",
    path,
    id: pick(5) > 0 ? `ID${pick(30)}` : idOf(path),
  }),
  ({ path }, machine) => ({
    edit: "remove_state",
    path: parentOf(path) ?? machine.root,
    state: idOf(path),
  }),
  ({ path }, _, pick) => ({
    edit: "set_runtime_value",
    path,
    list: one(["input", "output"] as const, pick) ?? "input",
    port: pick(3),
    value: pick(9),
  }),
  ({ path }, _, pick) => ({
    edit: "use_runtime_value",
    path,
    list: "input",
    port: pick(3),
    used: pick(2) > 0,
  }),
  (_, __, pick) => ({ edit: "set_version", version: pick(2) > 0 ? name(pick) : null }),
];
