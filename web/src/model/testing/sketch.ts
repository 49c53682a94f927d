/** Machines as short text, for tests:
 *
 *     R "Root" hierarchy 0 0 400 300 outcome done input speed:int=3 scoped found:list
 *       A "Scan" execution 20 20 80 60 outcome ok outcome lost output pose:list
 *       B execution 200 20 80 60 outcome ok input pose:list
 *       R > A
 *       A.ok > B
 *       B.ok > R.done
 *       A.pose >> B.pose
 *
 * Two spaces deeper is inside; lines with `>` are transitions and with `>>` data flows of the state around them. A library
 * state says `library=PATH/NAME`. */

import type { Document, JsonValue, StateDocument, StateKind } from "../generated/protocol.ts";
import { childPath, idOf } from "../path.ts";

type Draft = { -readonly [K in keyof StateDocument]: StateDocument[K] };

const STATE =
  /^(\S+)(?: "([^"]*)")? (execution|decider|hierarchy|barrier|preemptive|library)(?: (-?[\d.]+) (-?[\d.]+) ([\d.]+) ([\d.]+))?(.*)$/;

/** Parses a machine in short text. Throws if it is invalid. */
export function sketch(text: string): Document {
  const states: Draft[] = [];
  const around: Draft[] = [];
  for (const line of text.split("\n")) {
    if (line.trim() === "") continue;
    const depth = (line.length - line.trimStart().length) >> 1;
    around.length = Math.min(around.length, depth - base(text));
    const container = around.at(-1);
    if (line.includes(">")) connect(container, line.trim(), states);
    else {
      const state = readState(line.trim(), container);
      states.push(state);
      around.push(state);
    }
  }
  return { header: { creation_time: "2026-01-01 00:00:00" }, states };
}

function base(text: string): number {
  const first = text.split("\n").find((line) => line.trim() !== "") ?? "";
  return (first.length - first.trimStart().length) >> 1;
}

function readState(line: string, container: Draft | undefined): Draft {
  const found = STATE.exec(line);
  if (!found) throw new Error(`no state: ${line}`);
  const [, id = "", name, kind, x, y, width, height, rest = ""] = found;
  const state: Draft = {
    path: container ? childPath(container.path, id) : id,
    name: name ?? id,
    kind: kind as StateKind,
    outcomes: [
      { id: -2, name: "preempted" },
      { id: -1, name: "aborted" },
    ],
  };
  if (x !== undefined) {
    const [rel_pos, size] = [
      [Number(x), Number(y)],
      [Number(width), Number(height)],
    ];
    state.layout = { gui: { editor_gaphas: { rel_pos, size } } };
  }
  for (const [, word, value] of rest.matchAll(/(outcome|input|output|scoped|library)[ =](\S+)/g)) {
    part(state, word ?? "", value ?? "");
  }
  return state;
}

function part(state: Draft, word: string, value: string): void {
  const ports = [state.inputs, state.outputs, state.scoped_variables];
  const id = ports.reduce((count, list) => count + (list?.length ?? 0), 0);
  const [, name = "", data_type = "int", text] =
    /^([^:=]+)(?::([^=]+))?(?:=(.+))?$/.exec(value) ?? [];
  const port = {
    id,
    name,
    data_type,
    ...(text === undefined ? {} : { default: JSON.parse(text) as JsonValue }),
  };
  if (word === "outcome")
    state.outcomes = [
      ...(state.outcomes ?? []),
      { id: (state.outcomes?.length ?? 2) - 2, name: value },
    ];
  else if (word === "input") state.inputs = [...(state.inputs ?? []), port];
  else if (word === "output") state.outputs = [...(state.outputs ?? []), port];
  else if (word === "scoped") state.scoped_variables = [...(state.scoped_variables ?? []), port];
  else
    state.library = {
      path: value.slice(0, value.lastIndexOf("/")),
      name: value.slice(value.lastIndexOf("/") + 1),
    };
}

function connect(container: Draft | undefined, line: string, states: readonly Draft[]): void {
  const [, from, arrow, to] = /^(\S+) (>>?) (\S+)$/.exec(line) ?? [];
  if (!container || !from || !to) throw new Error(`no connection: ${line}`);
  const own = idOf(container.path);
  const end = (text: string) => {
    const [id = "", name] = text.split(".");
    const state =
      id === own ? container : states.find((each) => each.path === childPath(container.path, id));
    if (!state) throw new Error(`no state ${id} in ${container.path}: ${line}`);
    return { id, name, state };
  };
  const [source, target] = [end(from), end(to)];
  if (arrow === ">>") {
    const data_flows = container.data_flows ?? [];
    const flow = {
      id: data_flows.length,
      from_state: source.id,
      from_port: port(source),
      to_state: target.id,
      to_port: port(target),
    };
    container.data_flows = [...data_flows, flow];
    return;
  }
  const transitions = container.transitions ?? [];
  const begin = source.id === own ? {} : { from_state: source.id, from_outcome: outcome(source) };
  const goal = target.id === own ? { to_outcome: outcome(target) } : {};
  container.transitions = [
    ...transitions,
    { id: transitions.length, ...begin, to_state: target.id, ...goal },
  ];
}

interface End {
  readonly name: string | undefined;
  readonly state: Draft;
}

function port({ name, state }: End): number {
  const all = [
    ...(state.inputs ?? []),
    ...(state.outputs ?? []),
    ...(state.scoped_variables ?? []),
  ];
  return found(all, name, state);
}

function outcome({ name, state }: End): number {
  return found(state.outcomes ?? [], name, state);
}

function found(
  all: readonly { id: number; name: string }[],
  name: string | undefined,
  state: Draft,
): number {
  const one = all.find((each) => each.name === name);
  if (!one) throw new Error(`no ${name} in ${state.path}`);
  return one.id;
}
