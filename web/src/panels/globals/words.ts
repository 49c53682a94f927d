/** Texts about global variables, and their filter. */

import type { GlobalUse, GlobalVariable } from "../../model/globals.ts";
import type { Machine } from "../../model/machine.ts";

/** Variables with all words of the filter in their names, ignoring case. */
export function found(
  variables: readonly GlobalVariable[],
  query: string,
): readonly GlobalVariable[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  return variables.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
}

/** Such as `set Scan:3 gvm.set_variable("speed", 1)`. */
export function placeInWords(machine: Machine, { access, path, line, text }: GlobalUse): string {
  const state = machine.state(path)?.name ?? path;
  return `${access} ${state}${line === null ? "" : `:${line}`} ${text}`;
}

/** Such as `set once, read 3 times`. */
export function countsInWords({ uses }: GlobalVariable): string {
  const set = uses.filter(({ access }) => access === "set").length;
  const read = uses.length - set;
  return `${times("set", set)}, ${times("read", read)}`;
}

function times(word: string, count: number): string {
  if (count === 0) return `never ${word}`;
  return count === 1 ? `${word} once` : `${word} ${count} times`;
}
