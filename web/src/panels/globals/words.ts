/** Global variables in words, and those that a filter finds. */

import type { GlobalUse, GlobalVariable } from "../../model/globals.ts";
import { type Machine, namesTo } from "../../model/machine.ts";

/** Variables with all words of the filter in their name, whatever the case. */
export function found(
  variables: readonly GlobalVariable[],
  query: string,
): readonly GlobalVariable[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  return variables.filter(({ name }) => words.every((word) => name.toLowerCase().includes(word)));
}

/** Set or read, in which state, in which line, and how. */
export function placeInWords(machine: Machine, use: GlobalUse): readonly string[] {
  const place = namesTo(machine, use.path).join(" / ");
  return [use.access, place, ...(use.line === null ? [] : [`line ${use.line}`]), use.text];
}
