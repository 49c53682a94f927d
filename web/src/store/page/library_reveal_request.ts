/** The library that somebody asked to see in the tree of libraries: each asking is another object. */

import { type Signal, signal } from "@preact/signals-core";
import type { LibraryName } from "../../model/generated/protocol.ts";

export const libraryRevealRequest: Signal<LibraryName | null> = signal(null);
