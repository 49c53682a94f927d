/** Foretells edits of a state itself, of its runtime values and of the machine as a whole. */

import type {
  Edit,
  JsonValue,
  LibraryDocument,
  RuntimeValueDocument,
  StateDocument,
} from "../../model/generated/protocol.ts";
import type { Draft } from "./draft.ts";

type EditOf<K extends Edit["edit"]> = Extract<Edit, { edit: K }>;

/** Writes what the edit does; false if it is another kind of edit, or if only the server knows. */
export function own(draft: Draft, edit: Edit): boolean {
  switch (edit.edit) {
    case "set_name":
      return update(draft, edit.path, (state) => ({ ...state, name: edit.name }));
    case "set_description":
      return setField(draft, edit.path, "description", edit.description || null);
    case "set_semantic_data":
      return setField(draft, edit.path, "semantic_data", edit.semantic_data);
    case "set_script":
      return hasScript(draft, edit.path) && setField(draft, edit.path, "script", edit.script);
    case "set_runtime_value":
      return setValue(draft, edit, () => runtimeValue(edit.port, edit.value, true));
    case "use_runtime_value":
      return setValue(draft, edit, (earlier) => earlier && { ...earlier, used: edit.used });
    case "remove_runtime_value":
      return setValue(draft, edit, (earlier) => earlier && null);
    default:
      return header(draft, edit);
  }
}

/** Puts another state in the place of the one there; false if there is none. */
export function update(
  draft: Draft,
  path: string,
  next: (state: StateDocument) => StateDocument,
): boolean {
  const state = draft.state(path);
  if (state) draft.put(next(state));
  return state !== undefined;
}

/** Sets a field; null takes it out. */
export function setField<K extends "description" | "semantic_data" | "script" | "layout">(
  draft: Draft,
  path: string,
  field: K,
  value: StateDocument[K],
): boolean {
  return update(draft, path, (state) => {
    const { [field]: _, ...rest } = state;
    return value === null || value === undefined
      ? (rest as StateDocument)
      : { ...state, [field]: value };
  });
}

function hasScript(draft: Draft, path: string): boolean {
  const kind = draft.state(path)?.kind;
  return kind === "execution" || kind === "decider";
}

function runtimeValue(port: number, value: JsonValue, used: boolean): RuntimeValueDocument {
  return value === null ? { port, used } : { port, value, used };
}

type ValueEdit = EditOf<"set_runtime_value" | "use_runtime_value" | "remove_runtime_value">;

/** `next` gives null to take the value out, and nothing if it cannot be done. */
function setValue(
  draft: Draft,
  edit: ValueEdit,
  next: (earlier: RuntimeValueDocument | undefined) => RuntimeValueDocument | null | undefined,
): boolean {
  const list = edit.list === "input" ? "inputs" : "outputs";
  const state = draft.state(edit.path);
  if (!state?.library || edit.list === "scoped_variable") return false;
  const before = state.library[list] ?? [];
  const value = next(before.find(({ port }) => port === edit.port));
  if (value === undefined) return false;
  const others = before.filter(({ port }) => port !== edit.port);
  const after = value ? [...others, value].sort((one, other) => one.port - other.port) : others;
  draft.put({ ...state, library: withValues(state.library, list, after) });
  return true;
}

function withValues(
  library: LibraryDocument,
  list: "inputs" | "outputs",
  values: RuntimeValueDocument[],
): LibraryDocument {
  const { [list]: _, ...rest } = library;
  return values.length > 0 ? { ...library, [list]: values } : rest;
}

function header(draft: Draft, edit: Edit): boolean {
  if (edit.edit === "set_header") {
    draft.setHeader(edit.header);
    return true;
  }
  if (edit.edit === "set_version") {
    const { version: _, ...rest } = draft.header;
    draft.setHeader(edit.version === null ? rest : { ...rest, version: edit.version });
    return true;
  }
  if (edit.edit === "set_machine_layout") {
    const { layout: _, ...rest } = draft.header;
    draft.setHeader(edit.layout === null ? rest : { ...rest, layout: edit.layout });
    return true;
  }
  return false;
}
