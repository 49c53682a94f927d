/** Names in the place of state paths, in all that the page reports and asks. */

import type { OpenTab } from "./page.ts";

/** By the machine in front, then by the others that are open. */
export function withStateNames(
  tabs: readonly Pick<OpenTab, "session">[],
  front: Pick<OpenTab, "session"> | null,
  text: string,
): string {
  const sessions = new Set([front, ...tabs].flatMap((tab) => (tab ? [tab.session] : [])));
  return [...sessions].reduce((named, session) => session.named(named), text);
}
