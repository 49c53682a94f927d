/** Moments for people. */

const DAY_MS = 86_400_000;
const TIME = { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" } as const;

/** `14:03:27` of today, with the date if it was another day. */
export function moment(at_ms: number, now_ms: number): string {
  return withDate(at_ms, now_ms, TIME);
}

/** The same to the millisecond, `14:03:27.128`, where one thing follows another quickly. */
export function preciseMoment(at_ms: number, now_ms: number): string {
  return withDate(at_ms, now_ms, { ...TIME, fractionalSecondDigits: 3 });
}

function withDate(at_ms: number, now_ms: number, format: Intl.DateTimeFormatOptions): string {
  const at = new Date(at_ms);
  const time = at.toLocaleTimeString([], format);
  const isToday = new Date(now_ms).toDateString() === at.toDateString();
  if (isToday) return time;
  const isThisYear = now_ms - at_ms < 300 * DAY_MS;
  const year = isThisYear ? {} : { year: "numeric" as const };
  return `${at.toLocaleDateString([], { day: "numeric", month: "short", ...year })} ${time}`;
}
