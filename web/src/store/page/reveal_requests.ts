/** Requests that a panel reveals something. Each is a new object or number, so that a repeated request also has an effect. */

import { type Signal, signal } from "@preact/signals-core";
import type { LibraryName } from "../../model/generated/protocol.ts";

/** Library to reveal in the library tree. */
export const libraryRevealRequest: Signal<LibraryName | null> = signal(null);

/** Line of a script, from 1. The inspector reveals it once it shows the script. */
export const scriptLineRevealRequest: Signal<{
  readonly path: string;
  readonly line: number;
} | null> = signal(null);

/** Number of requested searches. The panel takes the keyboard focus at each. */
export const searchRevealRequest: Signal<number> = signal(0);
