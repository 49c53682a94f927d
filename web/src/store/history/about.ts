/** Finds the call that an event of a run belongs to. */

import { type Calls, NONE } from "./calls.ts";
import { lowerBound } from "./column.ts";

/** The call that the event begins or ends, or whose state it names; otherwise the innermost call open at that time. */
export function callAbout(calls: Calls, index: number): number {
  const entry = calls.journal.at(index);
  const path = entry && pathOf(entry);
  const call = path ? lastOf(calls, path, index) : NONE;
  const isHere = call !== NONE && (calls.isOpenAt(call, index) || calls.end(call) === index);
  return isHere ? call : calls.openAt(index);
}

function pathOf(entry: NonNullable<ReturnType<Calls["journal"]["at"]>>): string {
  if (entry.kind !== "other") return entry.path;
  return "path" in entry.event ? entry.event.path : "";
}

/** Last call of a state that began at this event or before it; NONE if none did. */
function lastOf(calls: Calls, path: string, index: number): number {
  const all = calls.of(path);
  const behind = lowerBound(all.length, (place) => calls.begin(all[place] ?? NONE) <= index);
  return all[behind - 1] ?? NONE;
}
