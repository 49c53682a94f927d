/** Replaces state paths by names in all messages and questions of the page. */

import type { OpenTab } from "./page.ts";

/** Uses the names of the machine in front first, then those of the other open machines. */
export function withStateNames(
  tabs: readonly Pick<OpenTab, "session">[],
  front: Pick<OpenTab, "session"> | null,
  text: string,
): string {
  const sessions = new Set([front, ...tabs].flatMap((tab) => (tab ? [tab.session] : [])));
  return [...sessions].reduce((named, session) => session.named(named), text);
}
