/** Storage of notices: equal ones are counted as one, a new one replaces its predecessor on a topic, and their number is limited.
 * Independent of their display. */

import type { Notice, Page } from "./page.ts";

/** Capacity of the log's notices. The least urgent is dropped first, of these the oldest. */
const KEPT_MAX = 1_000;
/** A notice that equals one of this many recent notices is counted with it. */
const FOLDED_MAX = 20;
/** Capacity of the notice centre. The most urgent come first, of these the newest. */
const OFFERED_MAX = 100;

/** A notice as it is reported, without the fields that storage adds. */
export type Telling = Omit<Notice, "id" | "at_ms" | "count" | "isClosed">;

/** Signals with the stored notices. */
export type KeptNotices = Pick<Page, "notices" | "droppedNotices">;

/** Adds a notice. */
export function putNotice(kept: KeptNotices, telling: Telling, id: number, at_ms: number): void {
  const all = withNotice(kept.notices.peek(), telling, id, at_ms);
  const dropped = all.length > KEPT_MAX ? leastUrgent(all) : undefined;
  if (dropped && isOpen(dropped)) kept.droppedNotices.value += 1;
  kept.notices.value = dropped ? all.filter((other) => other !== dropped) : all;
}

/** Closes notices: removes them from the notice centre, but not from the log. */
export function closeNotices({ notices }: KeptNotices, closed: readonly Notice[]): void {
  const ids = new Set(closed.map(({ id }) => id));
  notices.value = notices
    .peek()
    .map((notice) => (ids.has(notice.id) ? { ...notice, isClosed: true } : notice));
}

/** Removes all notices, also from the log. */
export function clearNotices({ notices, droppedNotices }: KeptNotices): void {
  notices.value = [];
  droppedNotices.value = 0;
}

function withNotice(
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
  return [...others, { ...telling, id, at_ms, count }];
}

/** The notice to drop. The newest is exempt, because its toast has not been shown yet. */
function leastUrgent(notices: readonly Notice[]): Notice | undefined {
  const earlier = notices.slice(0, -1);
  const least = Math.min(...earlier.map(urgency));
  return earlier.find((notice) => urgency(notice) === least);
}

/** From 0 for closed, quiet and passing notices to 3 for errors and offered actions. */
function urgency(notice: Notice): number {
  const { level, action, passing } = notice;
  // Mission control shows passing notices, too.
  if (!isOpen(notice) || passing) return 0;
  if (level === "error" || action) return 3;
  return level === "warning" ? 2 : 1;
}

/** Key that equal notices share, and all passing notices of a topic. */
export function keyOfNotice({ level, text, action, about, passing }: Telling): string {
  return passing ? `topic ${passing.topic}` : JSON.stringify([level, text, action, about]);
}

function isOpen({ isQuiet, isClosed }: Notice): boolean {
  return !isQuiet && !isClosed;
}

/** Open notices (shown to the user and not closed), the newest first. */
export function openNotices(notices: readonly Notice[]): readonly Notice[] {
  return notices.filter(isOpen).reverse();
}

/** The open notices that the notice centre shows. */
export function offeredNotices(open: readonly Notice[]): readonly Notice[] {
  if (open.length <= OFFERED_MAX) return open;
  const byUrgency = [...open].sort((one, other) => urgency(other) - urgency(one));
  const offered = new Set(byUrgency.slice(0, OFFERED_MAX));
  return open.filter((notice) => offered.has(notice));
}

/** Text of a notice with its count. */
export function noticeText({ text, count }: Pick<Notice, "text" | "count">): string {
  return count > 1 ? `${text} (${count} times)` : text;
}
