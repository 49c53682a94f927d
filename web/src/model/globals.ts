/** Global variables of a machine: every name that its scripts set or read, or that default values of its ports refer to by `$name`. */

import type { StateDocument } from "./generated/protocol.ts";
import { type Machine, type PortKind, portsOf } from "./machine.ts";
import { perOwner } from "./per_owner.ts";
import { lineAt, type ScriptUse, scriptUses } from "./python.ts";

/** One use of a global variable. */
export interface GlobalUse {
  /** Path of the state. */
  readonly path: string;
  readonly access: ScriptUse["access"];
  /** Line of the script, from 1; null for the default value of a port. */
  readonly line: number | null;
  /** Text of that line, or the port. */
  readonly text: string;
}

export interface GlobalVariable {
  readonly name: string;
  readonly uses: readonly GlobalUse[];
}

/** All global variables by ascending name, including the loaded content of libraries. */
export function globalsOf(machine: Machine): readonly GlobalVariable[] {
  const found = new Map<string, GlobalUse[]>();
  const look = (path: string, state: StateDocument) => {
    for (const [name, use] of usesOf(state, path)) {
      const uses = found.get(name);
      if (uses) uses.push(use);
      else found.set(name, [use]);
    }
  };
  const lookInside = (path: string) => {
    for (const child of machine.children(path)) {
      const state = machine.state(child);
      if (state) look(child, state);
      lookInside(child);
    }
  };
  for (const path of machine.paths()) {
    const state = machine.state(path);
    if (!state) continue;
    look(path, state);
    if (state.kind === "library") lookInside(path);
  }
  return [...found]
    .map(([name, uses]) => ({ name, uses }))
    .sort((one, other) => one.name.localeCompare(other.name));
}

type OwnUse = Omit<GlobalUse, "path"> & { readonly name: string };
type Uses = readonly (readonly [string, GlobalUse])[];

/** States are immutable, so each script is read once, wherever libraries place it. */
const ownUses = perOwner((state: StateDocument): readonly OwnUse[] => [
  ...inScript(state.script ?? ""),
  ...inDefaults(state),
]);
const PLACED = new WeakMap<StateDocument, { readonly path: string; readonly uses: Uses }>();

function usesOf(state: StateDocument, path: string): Uses {
  const known = PLACED.get(state);
  if (known?.path === path) return known.uses;
  const uses = ownUses(state).map(({ name, ...use }) => [name, { path, ...use }] as const);
  PLACED.set(state, { path, uses });
  return uses;
}

/** Every call that names a global variable. Most scripts have none and are not parsed. */
const CALL = /_variable\b|\bvariable_|\b(is_locked|get_data_type|get_representation)\b/;

/** Cache by script, because large machines contain many copies of a script. */
const SCRIPTS = new Map<string, readonly OwnUse[]>();
const SCRIPTS_MAX = 4096;

function inScript(script: string): readonly OwnUse[] {
  if (!CALL.test(script)) return [];
  const known = SCRIPTS.get(script);
  if (known) return known;
  const uses = scriptUses(script).flatMap(({ of, name, access, from }) =>
    of === "global" ? [{ name, access, ...lineAt(script, from) }] : [],
  );
  if (SCRIPTS.size >= SCRIPTS_MAX) SCRIPTS.clear();
  SCRIPTS.set(script, uses);
  return uses;
}

const WORDS: Readonly<Record<PortKind, string>> = {
  input: "input",
  output: "output",
  scoped_variable: "scoped variable",
};

function inDefaults(state: StateDocument): readonly OwnUse[] {
  const use = (value: unknown, text: string): readonly OwnUse[] =>
    typeof value === "string" && /^\$./.test(value)
      ? [{ name: value.slice(1), access: "read", line: null, text }]
      : [];
  const lists = Object.keys(WORDS) as PortKind[];
  const defaults = lists.flatMap((kind) =>
    portsOf(state, kind).flatMap((port) =>
      use(port.default, `default of ${WORDS[kind]} ${port.name}`),
    ),
  );
  const set = [...(state.library?.inputs ?? []), ...(state.library?.outputs ?? [])];
  return [
    ...defaults,
    ...set.flatMap((port) => (port.used ? use(port.value, `value of port ${port.port}`) : [])),
  ];
}
