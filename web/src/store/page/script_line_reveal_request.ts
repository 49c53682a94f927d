/** A line of a script that somebody asked to see: the inspector shows it once it shows the script. */

import { type Signal, signal } from "@preact/signals-core";

interface ScriptLine {
  readonly path: string;
  /** From 1. */
  readonly line: number;
}

export const scriptLineRevealRequest: Signal<ScriptLine | null> = signal<ScriptLine | null>(null);
