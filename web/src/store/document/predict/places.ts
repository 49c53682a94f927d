/** Predicts positions on the screen, by the keys of the reference's layout (docs/format.md). */

import type {
  Edit,
  Element,
  LayoutDocument,
  StateDocument,
} from "../../../model/generated/protocol.ts";
import { setField, update } from "./own.ts";
import type { PredictedMachine } from "./predicted_machine.ts";

/** Predicts the edit; false if it is of another kind, or if only the server knows its effect. */
export function places(predicted: PredictedMachine, edit: Edit): boolean {
  switch (edit.edit) {
    case "set_position":
      return setPlace(predicted, edit, "rel_pos", tuple(edit.position));
    case "set_size":
      return setPlace(predicted, edit, "size", tuple(edit.size));
    case "set_waypoints":
      return setPlace(predicted, edit, "waypoints", edit.waypoints.map(tuple));
    case "set_layout":
      return setField(predicted, edit.path, "layout", unlessEmpty(edit.layout));
    default:
      return false;
  }
}

/** The state without the positions of removed elements, by their keys in the layout. */
export function withoutPlaces(state: StateDocument, keys: readonly string[]): StateDocument {
  const { layout } = state;
  if (!layout || !keys.some((key) => key in layout)) return state;
  const { layout: _, ...rest } = state;
  const entries = Object.entries(layout).filter(([key]) => !keys.includes(key));
  const left = unlessEmpty(Object.fromEntries(entries));
  return left ? { ...rest, layout: left } : (rest as StateDocument);
}

/** Null for an empty layout. */
function unlessEmpty(layout: LayoutDocument | null): LayoutDocument | null {
  return layout && Object.keys(layout).length > 0 ? layout : null;
}

const PREFIXES: Record<string, string> = {
  outcome: "outcome",
  input: "input_data_port",
  output: "output_data_port",
  scoped_variable: "scoped_variable",
  transition: "transition",
  data_flow: "data_flow",
};

/** Key of an element's position in the layout of its state. */
export function placeKey(kind: string, id: number): string {
  return `${PREFIXES[kind] ?? kind}${id}`;
}

interface PlaceEdit {
  readonly path: string;
  readonly element: Element;
}

function setPlace(
  predicted: PredictedMachine,
  edit: PlaceEdit,
  field: string,
  value: unknown,
): boolean {
  const keys = [...keysOf(edit.element), field];
  return update(predicted, edit.path, (state) => ({
    ...state,
    layout: setAt(state.layout ?? {}, keys, value),
  }));
}

/** Keys from the outside in. */
function keysOf(element: Element): readonly string[] {
  if (element === "state") return ["gui", "editor_gaphas"];
  if (element === "name") return ["gui", "editor_gaphas", "name"];
  if (element === "income") return ["income", "gui", "editor_gaphas"];
  const [kind, id] = Object.entries(element)[0] ?? ["", 0];
  return [placeKey(kind, id), "gui", "editor_gaphas"];
}

function setAt(json: LayoutDocument, keys: readonly string[], value: unknown): LayoutDocument {
  const [key = "", ...rest] = keys;
  if (rest.length === 0) return { ...json, [key]: value };
  const inner = json[key];
  const isObject = typeof inner === "object" && inner !== null && !Array.isArray(inner);
  return { ...json, [key]: setAt(isObject ? (inner as LayoutDocument) : {}, rest, value) };
}

/** A point in the notation of the file. */
function tuple([x, y]: readonly [number, number]): unknown {
  return { __jsonqualname__: "__builtin__.tuple", items: [x, y] };
}
