/** How often somebody asked to search: the panel takes the keyboard each time. */

import { type Signal, signal } from "@preact/signals-core";

export const searchRevealRequest: Signal<number> = signal(0);
