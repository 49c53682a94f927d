/** What a panel is being dragged from: browsers tell the content of a drag only when it is dropped. */

import { type Signal, signal } from "@preact/signals-core";
import type { StateKind } from "../../model/generated/protocol.ts";

export type Dragged =
  | { readonly insert: Exclude<StateKind, "library" | "decider"> }
  | { readonly library: { readonly path: string; readonly name: string } };

/** Set when a drag begins, and null again when it ends, wherever that is. */
export const dragged: Signal<Dragged | null> = signal<Dragged | null>(null);

/** The type under which the same is in the drag's own data, as JSON. */
export const DRAGGED_TYPE = "application/x-rafcon";
