/** Before the page goes: the browser asks only if something that was done here has not reached the server. */

import type { AppSession } from "./session.ts";

/** True if an edit waits for its answer. The server stores answered edits. */
function isUnsent({ page }: AppSession): boolean {
  return page.tabs.peek().some(({ session }) => session.pending.peek().length > 0);
}

export function guardLeaving(session: AppSession, view: Window): () => void {
  const leave = (event: BeforeUnloadEvent) => {
    if (isUnsent(session)) event.preventDefault();
  };
  view.addEventListener("beforeunload", leave);
  return () => view.removeEventListener("beforeunload", leave);
}
