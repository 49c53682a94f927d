/** Times in UTC that users enter. */

const FORM = /^\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?Z?$/;

/** Hint for a field of a time in UTC. */
export const UTC_HINT = "enter a time in UTC, such as 2026-11-28 14:10:00";

/** The time in ms since 1970; null if the text is no time. */
export function utcEntered(text: string): number | null {
  const trimmed = text.trim();
  if (!FORM.test(trimmed)) return null;
  const at_ms = Date.parse(`${trimmed.replace(" ", "T").replace("Z", "")}Z`);
  return Number.isNaN(at_ms) ? null : at_ms;
}

/** Such as `2026-11-28T14:10:00Z`, with milliseconds if there are any. */
export function utcText(at_ms: number): string {
  return new Date(at_ms).toISOString().replace(".000Z", "Z");
}
