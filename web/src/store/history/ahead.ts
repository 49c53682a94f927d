/** Values of a robot's run that the server sends ahead of their events. */

import type { WatchedValue, Watching } from "../../model/generated/protocol.ts";

export interface AheadValues {
  /** State of the watch request to the robot; null if none is sent. */
  readonly watching: Watching | null;
  readonly values: ReadonlyMap<string, WatchedValue>;
}

export const NOTHING_AHEAD: AheadValues = { watching: null, values: new Map() };

export function aheadKey({ kind, path, name }: Pick<WatchedValue, "kind" | "path" | "name">) {
  return `${kind} ${path} ${name}`;
}
