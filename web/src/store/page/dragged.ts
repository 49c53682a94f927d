/** Item that is being dragged from a panel. Browsers reveal the data of a drag only when it is dropped. */

import { type Signal, signal } from "@preact/signals-core";
import type { StateKind } from "../../model/generated/protocol.ts";

export type Dragged =
  | { readonly insert: Exclude<StateKind, "library" | "decider"> }
  | { readonly library: { readonly path: string; readonly name: string } };

/** Set when a drag starts, and null after it has ended, wherever that happens. */
export const dragged: Signal<Dragged | null> = signal<Dragged | null>(null);

/** Type of this item in the data of the drag, as JSON. */
export const DRAGGED_TYPE = "application/x-rafcon";
