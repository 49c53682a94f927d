/** A port, outcome or global variable gets another name, and the scripts that call it by the old one follow. */

import type { ElementRef } from "../model/element.ts";
import { isPort } from "../model/ends.ts";
import type { Edit, LibraryDocument, StateDocument } from "../model/generated/protocol.ts";
import { type Machine, outcomesOf, portsOf } from "../model/machine.ts";
import { renameInScript, type ScriptUse, scriptUses } from "../model/python.ts";
import { isRefused, type Planned, refused, together } from "./plan.ts";
import { renameOutcome, renamePort } from "./ports.ts";
import { setScript } from "./states.ts";

/** Occurrences of the port's or outcome's name in the script of its state. */
export function usesInScript(machine: Machine, element: ElementRef): readonly ScriptUse[] {
  const state = machine.state(element.path);
  const name = nameOf(machine, element);
  if (!state?.script || name === undefined) return [];
  return scriptUses(state.script).filter((use) => use.of === element.kind && use.name === name);
}

function nameOf(machine: Machine, element: ElementRef): string | undefined {
  const state = machine.state(element.path);
  if (!state) return undefined;
  if (element.kind === "outcome")
    return outcomesOf(state).find(({ id }) => id === element.id)?.name;
  if (!isPort(element)) return undefined;
  return portsOf(state, element.kind).find(({ id }) => id === element.id)?.name;
}

/** Another name for a port or outcome: connections follow by themselves, and with `inScript` the script does too. */
export function renameElement(
  machine: Machine,
  element: ElementRef,
  name: string,
  inScript: boolean,
): Planned {
  const renamed =
    element.kind === "outcome"
      ? renameOutcome(machine, element, name)
      : renamePort(machine, element, name);
  const uses = inScript ? usesInScript(machine, element) : [];
  const script = machine.state(element.path)?.script ?? "";
  if (isRefused(renamed) || uses.length === 0) return renamed;
  const written = setScript(machine, element.path, renameInScript(script, uses, name.trim()));
  if (isRefused(written)) return written;
  return {
    name: `${renamed.name} in its script too`,
    edit: together([renamed.edit, written.edit]),
  };
}

/** Another name for a global variable in every script of the machine; libraries keep theirs. */
export function renameGlobal(machine: Machine, from: string, to: string): Planned {
  const name = to.trim();
  if (name === "") return refused(`A global variable needs a name: ${from} keeps its name.`);
  const edits: Edit[] = [];
  for (const path of machine.paths()) {
    const script = machine.state(path)?.script ?? "";
    const uses = scriptUses(script).filter((use) => use.of === "global" && use.name === from);
    if (uses.length === 0) continue;
    edits.push({ edit: "set_script", path, script: renameInScript(script, uses, name) });
  }
  edits.push(...defaultsOf(machine, from, name));
  if (edits.length === 0)
    return refused(`No script of this machine uses the name ${from} in quotes.`);
  return { name: `Rename global variable ${from}`, edit: together(edits) };
}

/** Defaults and values that are `$name`. */
function defaultsOf(machine: Machine, from: string, name: string): readonly Edit[] {
  return [...machine.paths()].flatMap((path) => {
    const state = machine.state(path);
    if (!state) return [];
    return state.library
      ? valuesOf(path, state.library, from, name)
      : ownDefaults(path, state, from, name);
  });
}

function valuesOf(path: string, library: LibraryDocument, from: string, name: string): Edit[] {
  return (["input", "output"] as const).flatMap((list) =>
    (library[`${list}s`] ?? [])
      .filter(({ value }) => value === `$${from}`)
      .map(({ port }) => ({ edit: "set_runtime_value", path, list, port, value: `$${name}` })),
  );
}

function ownDefaults(path: string, state: StateDocument, from: string, name: string): Edit[] {
  return (["input", "output", "scoped_variable"] as const).flatMap((list) =>
    portsOf(state, list)
      .filter((port) => port.default === `$${from}`)
      .map(({ id }) => ({ edit: "set_port_default", path, list, port: id, default: `$${name}` })),
  );
}
