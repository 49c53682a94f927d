/** Which call an event of a run is about. */

import { type Calls, NONE } from "./calls.ts";
import { lowerBound } from "./column.ts";

/** The call that begins or ends by the event, or whose state the event names; else the innermost one that was open then. */
export function callAbout(calls: Calls, index: number): number {
  const happening = calls.journal.at(index);
  const path = happening && pathOf(happening);
  const call = path ? lastOf(calls, path, index) : NONE;
  const isHere = call !== NONE && (calls.isOpenAt(call, index) || calls.end(call) === index);
  return isHere ? call : calls.openAt(index);
}

function pathOf(happening: NonNullable<ReturnType<Calls["journal"]["at"]>>): string {
  if (happening.kind !== "other") return happening.path;
  return "path" in happening.event ? happening.event.path : "";
}

/** The last call of a state that began at the event or before; NONE if none did. */
function lastOf(calls: Calls, path: string, index: number): number {
  const all = calls.of(path);
  const behind = lowerBound(all.length, (place) => calls.begin(all[place] ?? NONE) <= index);
  return all[behind - 1] ?? NONE;
}
