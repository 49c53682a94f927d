/** Values of a robot's run that are here before their events, as the server tells them. */

import type { WatchedValue, Watching } from "../../model/generated/protocol.ts";

export interface AheadValues {
  /** Whether the robot knows what is watched; null: it is not asked. */
  readonly watching: Watching | null;
  readonly values: ReadonlyMap<string, WatchedValue>;
}

export const NOTHING_AHEAD: AheadValues = { watching: null, values: new Map() };

export function aheadKey({ kind, path, name }: Pick<WatchedValue, "kind" | "path" | "name">) {
  return `${kind} ${path} ${name}`;
}
