/** Arrays of numbers in values of any type: data for plots and images. */

import type { JsonValue } from "./generated/protocol.ts";
import { type Read, read } from "./wire.ts";

export interface NumberArray {
  /** Row by row. */
  readonly items: readonly number[];
  /** Number of items along each axis. */
  readonly shape: readonly number[];
  /** Step between kept items of the value along each axis. */
  readonly steps: readonly number[];
  readonly dtype: string | null;
}

/** Numbers of an array, of a list of at least two numbers, or of lists of numbers with equal lengths; null for other values. */
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

/** Least and greatest finite number; null if there is none. */
export function range(items: readonly number[]): readonly [number, number] | null {
  const finite = items.filter((item) => Number.isFinite(item));
  if (finite.length === 0) return null;
  return [Math.min(...finite), Math.max(...finite)];
}

/** True if the array is an image with three or four colour channels per point. */
export function isColoured({ shape, dtype }: NumberArray): boolean {
  const depth = shape[2] ?? 0;
  return shape.length === 3 && (depth === 3 || depth === 4) && (dtype ?? "").startsWith("uint8");
}

/** Columns of a list of at least two dicts that share a key; null for other values. */
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

/** Greatest number of columns of a readable table. */
const KEYS_MAX = 12;

export interface Records {
  readonly keys: readonly string[];
  readonly rows: readonly ReadonlyMap<string, JsonValue>[];
}
