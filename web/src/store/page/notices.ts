/** How notices are kept: equal ones as one that counts, news of a topic in the place of the one before, and how many there are at
 * most. Knows nothing of how they are shown. */

import type { Notice } from "./page.ts";

/** So many are kept: the log shows them all. */
const KEPT_MAX = 1_000;
/** A notice that says the same as one of the last so many is counted with it. */
const FOLDED_MAX = 20;
/** So many are offered in the notice centre, the newest. */
const OFFERED_MAX = 100;

/** A notice as it is told, without what keeping it adds. */
export type Telling = Omit<Notice, "id" | "at_ms" | "count">;

/** The notices with one more. */
export function withNotice(
  before: readonly Notice[],
  telling: Telling,
  id: number,
  at_ms: number,
): readonly Notice[] {
  const key = keyOfNotice(telling);
  const isSame = (other: Notice) => keyOfNotice(other) === key;
  const same = telling.passing
    ? undefined
    : before.slice(-FOLDED_MAX).findLast((other) => !other.passing && isSame(other));
  const others = before.filter((other) =>
    telling.passing ? other.passing?.topic !== telling.passing.topic : other !== same,
  );
  const count = (same?.count ?? 0) + 1;
  return [...others, { ...telling, id, at_ms, count }].slice(-KEPT_MAX);
}

/** The same for equal notices, and for all news of one topic. */
export function keyOfNotice({ level, text, action, about, passing }: Telling): string {
  return passing ? `topic ${passing.topic}` : JSON.stringify([level, text, action, about]);
}

/** Those that somebody may still want: told to the user and not closed, the newest first. */
export function openNotices(
  notices: readonly Notice[],
  closed: ReadonlySet<number>,
): readonly Notice[] {
  const open = notices.filter(({ id, isQuiet }) => !isQuiet && !closed.has(id));
  return open.slice(-OFFERED_MAX).reverse();
}

/** What it says, with how often it was said. */
export function noticeText({ text, count }: Pick<Notice, "text" | "count">): string {
  return count > 1 ? `${text} (${count} times)` : text;
}
