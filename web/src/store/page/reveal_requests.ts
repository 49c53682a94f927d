/** What the user asked a panel to show. Each request is another object, or another number, so that the same can be asked again. */

import { type Signal, signal } from "@preact/signals-core";
import type { LibraryName } from "../../model/generated/protocol.ts";

/** The library to show in the tree of libraries. */
export const libraryRevealRequest: Signal<LibraryName | null> = signal(null);

/** The line of a script, from 1: the inspector shows it once it shows the script. */
export const scriptLineRevealRequest: Signal<{
  readonly path: string;
  readonly line: number;
} | null> = signal(null);

/** How often a search was requested: the panel takes the keyboard each time. */
export const searchRevealRequest: Signal<number> = signal(0);
