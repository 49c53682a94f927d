/** Changed fields of a state, before and after. */

import type { LibraryDocument, RuntimeValueDocument, StateDocument } from "./generated/protocol.ts";
import { isSame } from "./json.ts";
import { type PortKind, portsOf } from "./machine.ts";
import { python } from "./value.ts";

/** Old and new value of an element's field, in words. */
export interface FieldChange {
  readonly field: string;
  readonly old: string;
  readonly now: string;
  /** True for texts of several lines, which are shown as a difference. */
  readonly isText: boolean;
}

/** Changed fields: name, kind, texts, library and its values. */
export function stateFields(old: StateDocument, now: StateDocument): readonly FieldChange[] {
  return [
    ...field("name", old.name, now.name),
    ...field("kind", old.kind, now.kind),
    ...field("description", old.description ?? "", now.description ?? "", true),
    ...field("script", old.script ?? "", now.script ?? "", true),
    ...field("semantic data", json(old.semantic_data), json(now.semantic_data), true),
    ...field("library", libraryName(old.library), libraryName(now.library)),
    ...field("version of the library", old.library?.version ?? "", now.library?.version ?? ""),
    ...values(old, now, "input"),
    ...values(old, now, "output"),
  ];
}

function field(name: string, old: string, now: string, isText = false): readonly FieldChange[] {
  return old === now ? [] : [{ field: name, old, now, isText }];
}

function json(value: unknown): string {
  return value === null || value === undefined ? "" : JSON.stringify(value, null, 2);
}

function libraryName(library: LibraryDocument | null | undefined): string {
  return library ? `${library.path}/${library.name}` : "";
}

/** Changed values that a library state sets for its ports. */
function values(
  old: StateDocument,
  now: StateDocument,
  kind: Exclude<PortKind, "scoped_variable">,
): readonly FieldChange[] {
  const list = kind === "input" ? "inputs" : "outputs";
  const before = new Map((old.library?.[list] ?? []).map((value) => [value.port, value]));
  const after = new Map((now.library?.[list] ?? []).map((value) => [value.port, value]));
  const ports = new Set([...before.keys(), ...after.keys()]);
  return [...ports].flatMap((port) => {
    const [one, other] = [before.get(port), after.get(port)];
    if (isSame(one, other)) return [];
    const named = [...portsOf(now, kind), ...portsOf(old, kind)].find(({ id }) => id === port);
    return field(`value of ${named?.name ?? `${kind} ${port}`}`, inWords(one), inWords(other));
  });
}

function inWords(value: RuntimeValueDocument | undefined): string {
  if (!value) return "";
  return `${python(value.value)}${value.used ? "" : " (not used)"}`;
}
