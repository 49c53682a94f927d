/** Comparison of JSON values. */

/** True if two values are equal, whatever the order of object keys. Missing keys equal undefined ones. */
export function isSame(one: unknown, other: unknown): boolean {
  if (one === other) return true;
  if (typeof one !== "object" || typeof other !== "object" || !one || !other) return false;
  if (Array.isArray(one) || Array.isArray(other)) {
    if (!Array.isArray(one) || !Array.isArray(other) || one.length !== other.length) return false;
    return one.every((value, index) => isSame(value, other[index]));
  }
  return isSameObject(one as Record<string, unknown>, other as Record<string, unknown>);
}

function isSameObject(one: Record<string, unknown>, other: Record<string, unknown>): boolean {
  const keys = Object.keys(one);
  for (const key of keys) if (!isSame(one[key], other[key])) return false;
  return Object.keys(other).every((key) => key in one || other[key] === undefined);
}
