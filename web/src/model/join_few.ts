/** Shortens a list of names: the first ones, and the number of the others. */

const SHOWN_MAX = 2;

/** `“A”, “B”`, `“A”, “B” and 3 more`. */
export function joinFew(names: readonly string[]): string {
  // “and 1 more” is no shorter than a name.
  const count = names.length <= SHOWN_MAX + 1 ? names.length : SHOWN_MAX;
  const shown = names
    .slice(0, count)
    .map((name) => `“${name}”`)
    .join(", ");
  return count === names.length ? shown : `${shown} and ${names.length - count} more`;
}
