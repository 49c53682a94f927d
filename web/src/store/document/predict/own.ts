/** Predicts edits of a state itself, of its runtime values and of the header of the machine. */

import type {
  Edit,
  JsonValue,
  LibraryDocument,
  RuntimeValueDocument,
  StateDocument,
} from "../../../model/generated/protocol.ts";
import type { PredictedMachine } from "./predicted_machine.ts";

type EditOf<K extends Edit["edit"]> = Extract<Edit, { edit: K }>;

/** Predicts the edit; false if it is of another kind, or if only the server knows its effect. */
export function own(predicted: PredictedMachine, edit: Edit): boolean {
  switch (edit.edit) {
    case "set_name":
      return update(predicted, edit.path, (state) => ({ ...state, name: edit.name }));
    case "set_description":
      return setField(predicted, edit.path, "description", edit.description || null);
    case "set_semantic_data":
      return setField(predicted, edit.path, "semantic_data", edit.semantic_data);
    case "set_script":
      return (
        hasScript(predicted, edit.path) && setField(predicted, edit.path, "script", edit.script)
      );
    case "set_runtime_value":
      return setValue(predicted, edit, () => runtimeValue(edit.port, edit.value, true));
    case "use_runtime_value":
      return setValue(predicted, edit, (earlier) => earlier && { ...earlier, used: edit.used });
    case "remove_runtime_value":
      return setValue(predicted, edit, (earlier) => earlier && null);
    default:
      return header(predicted, edit);
  }
}

/** Replaces a state; false if it does not exist. */
export function update(
  predicted: PredictedMachine,
  path: string,
  next: (state: StateDocument) => StateDocument,
): boolean {
  const state = predicted.state(path);
  if (state) predicted.put(next(state));
  return state !== undefined;
}

/** Sets a field; null removes it. */
export function setField<K extends "description" | "semantic_data" | "script" | "layout">(
  predicted: PredictedMachine,
  path: string,
  field: K,
  value: StateDocument[K],
): boolean {
  return update(predicted, path, (state) => {
    const { [field]: _, ...rest } = state;
    return value === null || value === undefined
      ? (rest as StateDocument)
      : { ...state, [field]: value };
  });
}

function hasScript(predicted: PredictedMachine, path: string): boolean {
  const kind = predicted.state(path)?.kind;
  return kind === "execution" || kind === "decider";
}

function runtimeValue(port: number, value: JsonValue, used: boolean): RuntimeValueDocument {
  return value === null ? { port, used } : { port, value, used };
}

type ValueEdit = EditOf<"set_runtime_value" | "use_runtime_value" | "remove_runtime_value">;

/** `next` returns null to remove the value, and undefined if the edit is impossible. */
function setValue(
  predicted: PredictedMachine,
  edit: ValueEdit,
  next: (earlier: RuntimeValueDocument | undefined) => RuntimeValueDocument | null | undefined,
): boolean {
  const list = edit.list === "input" ? "inputs" : "outputs";
  const state = predicted.state(edit.path);
  if (!state?.library || edit.list === "scoped_variable") return false;
  const before = state.library[list] ?? [];
  const value = next(before.find(({ port }) => port === edit.port));
  if (value === undefined) return false;
  const others = before.filter(({ port }) => port !== edit.port);
  const after = value ? [...others, value].sort((one, other) => one.port - other.port) : others;
  predicted.put({ ...state, library: withValues(state.library, list, after) });
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

function header(predicted: PredictedMachine, edit: Edit): boolean {
  if (edit.edit === "set_header") {
    predicted.setHeader(edit.header);
    return true;
  }
  if (edit.edit === "set_version") {
    const { version: _, ...rest } = predicted.header;
    predicted.setHeader(edit.version === null ? rest : { ...rest, version: edit.version });
    return true;
  }
  if (edit.edit === "set_machine_layout") {
    const { layout: _, ...rest } = predicted.header;
    predicted.setHeader(edit.layout === null ? rest : { ...rest, layout: edit.layout });
    return true;
  }
  return false;
}
