/** Lists of a state: elements with an id, in ascending order; empty lists are omitted. */

import type { StateDocument } from "../../model/generated/protocol.ts";

interface Numbered {
  readonly id: number;
}

type ListName =
  | "outcomes"
  | "inputs"
  | "outputs"
  | "scoped_variables"
  | "transitions"
  | "data_flows";

/** The list with this element under its id; without an element, the list without this id. */
export function placed<T extends Numbered>(
  list: readonly T[] | undefined,
  id: number,
  element: T | null | undefined,
): T[] {
  const others = (list ?? []).filter((other) => other.id !== id);
  if (!element) return others;
  const at = others.findIndex((other) => other.id > id);
  return others.toSpliced(at < 0 ? others.length : at, 0, element);
}

/** The state with one list replaced. */
export function withList<N extends ListName>(
  state: StateDocument,
  name: N,
  list: NonNullable<StateDocument[N]>,
): StateDocument {
  if (list.length > 0) return { ...state, [name]: list };
  const { [name]: _, ...rest } = state;
  return rest as StateDocument;
}
