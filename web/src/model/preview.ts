/** The beginning of a value that is too long: more than its type, less than all of it. */

import { shortValue } from "./short_value.ts";
import { read, typeWords } from "./wire.ts";

/** Greatest length of an inner value. */
const INSIDE_MAX = 24;
const MORE = ", …";

/** Returns `shortValue` if that shows more than the type. For a longer dict or list, shows the parts that fit: `{frame: "map",
 * joints: dict ⟨9⟩, …}`. */
export function previewValue(value: unknown, max: number): string {
  const short = shortValue(value, max);
  const found = read(value);
  if (short !== typeWords(found)) return short;
  switch (found.kind) {
    case "dict": {
      const parts = found.entries.map(([key, item]) => `${key}: ${shortValue(item, INSIDE_MAX)}`);
      return began(parts, found.count, max, "{", "}") ?? short;
    }
    case "list": {
      const [open, close] = { list: "[]", tuple: "()", set: "{}" }[found.of];
      const parts = found.items.slice(0, max).map((item) => shortValue(item, INSIDE_MAX));
      return began(parts, found.count, max, open ?? "", close ?? "") ?? short;
    }
    default:
      return short;
  }
}

/** The parts that fit; null if none does. */
function began(
  parts: readonly string[],
  count: number,
  max: number,
  open: string,
  close: string,
): string | null {
  let inner = "";
  let included = 0;
  for (const part of parts) {
    const next = included === 0 ? part : `${inner}, ${part}`;
    if (next.length + 2 + MORE.length > max) break;
    inner = next;
    included += 1;
  }
  if (included === 0) return null;
  return `${open}${inner}${included < count ? MORE : ""}${close}`;
}
