/** Numbers in rows, of whatever value holds them: what can be plotted, or looked at as an image. */

import type { JsonValue } from "./generated/protocol.ts";
import { type Read, read } from "./wire.ts";

export interface NumberArray {
  /** Row by row. */
  readonly items: readonly number[];
  /** How many along each axis. */
  readonly shape: readonly number[];
  /** How far apart they stood in the value along each axis. */
  readonly steps: readonly number[];
  readonly dtype: string | null;
}

/** The numbers of an array, a list of at least two numbers, or lists of numbers of one length; null of anything else. */
export function numbersOf(found: Read): NumberArray | null {
  if (found.kind === "array") {
    const { items, sampled, steps, dtype } = found;
    return items && items.length > 1 ? { items, shape: sampled, steps, dtype } : null;
  }
  if (found.kind !== "list" || found.of === "set" || found.items.length < 2) return null;
  const row = plain(found.items);
  if (row) return { items: row, shape: [row.length], steps: [1], dtype: null };
  const rows = found.items.map((item) => {
    const inner = read(item);
    const isWhole = inner.kind === "list" && inner.items.length === inner.count;
    return isWhole ? plain(inner.items) : null;
  });
  const width = rows[0]?.length ?? 0;
  if (width === 0 || rows.some((each) => each?.length !== width)) return null;
  const items = rows.flatMap((each) => each ?? []);
  return { items, shape: [rows.length, width], steps: [1, 1], dtype: null };
}

function plain(items: readonly JsonValue[]): readonly number[] | null {
  const found = items.map(read);
  const values = found.flatMap((each) => (each.kind === "number" ? [each.value] : []));
  return values.length === found.length ? values : null;
}

/** The least and the greatest of what is finite; null if nothing is. */
export function range(items: readonly number[]): readonly [number, number] | null {
  const finite = items.filter((item) => Number.isFinite(item));
  if (finite.length === 0) return null;
  return [Math.min(...finite), Math.max(...finite)];
}

/** Whether three or four numbers stand for the colour of each point. */
export function isColoured({ shape, dtype }: NumberArray): boolean {
  const depth = shape[2] ?? 0;
  return shape.length === 3 && (depth === 3 || depth === 4) && (dtype ?? "").startsWith("uint8");
}

/** The columns of a list of at least two dicts that share a key; null of anything else. */
export function recordsOf(found: Read): Records | null {
  if (found.kind !== "list" || found.items.length < 2) return null;
  const rows = found.items.map((item) => {
    const inner = read(item);
    return inner.kind === "dict" ? new Map(inner.entries) : null;
  });
  if (!rows.every((row) => row !== null)) return null;
  const keys = [...new Set(rows.flatMap((row) => [...row.keys()]))];
  const isShared = keys.some((key) => rows.every((row) => row.has(key)));
  return isShared && keys.length <= KEYS_MAX ? { keys, rows } : null;
}

/** More columns are no table that anybody reads. */
const KEYS_MAX = 12;

export interface Records {
  readonly keys: readonly string[];
  readonly rows: readonly ReadonlyMap<string, JsonValue>[];
}
