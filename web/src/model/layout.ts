/** Writes changes into a layout: the inverse of layout_reader.ts. Unknown keys are kept. */

import type { LayoutDocument, StateDocument } from "./generated/protocol.ts";
import type { Box, Point, Size } from "./geometry.ts";
import { readLayout } from "./layout_reader.ts";

/** Changed values; missing ones stay. Keys of ports and connections are those of the file: `outcome-1`. */
export interface LayoutChange {
  readonly position?: Point | undefined;
  readonly size?: Size | undefined;
  readonly nameBox?: Box | undefined;
  /** Red, green and blue from 0 to 1; null removes the colour. */
  readonly background?: readonly [number, number, number] | null | undefined;
  readonly showsContent?: boolean | undefined;
  readonly ports?: ReadonlyMap<string, Point> | undefined;
  readonly waypoints?: ReadonlyMap<string, readonly Point[]> | undefined;
}

type LayoutEntry = Record<string, unknown>;

/** The layout with the change applied. */
export function changed(
  layout: LayoutDocument | null | undefined,
  change: LayoutChange,
): LayoutDocument {
  const own = ownPart(change);
  let found: LayoutEntry = { ...layout };
  if (Object.keys(own).length > 0) found = merged(found, own);
  if (change.showsContent !== undefined) {
    found["gui"] = { ...asEntry(found["gui"]), show_content: change.showsContent };
  }
  for (const [key, at] of change.ports ?? []) {
    found[key] = merged(asEntry(found[key]), { rel_pos: pair(at.x, at.y) });
  }
  for (const [key, points] of change.waypoints ?? []) {
    const waypoints = points.map(({ x, y }) => pair(x, y));
    found[key] = merged(asEntry(found[key]), { waypoints });
  }
  return found;
}

function ownPart({ position, size, nameBox, background }: LayoutChange): LayoutEntry {
  return {
    ...(position && { rel_pos: pair(position.x, position.y) }),
    ...(size && { size: pair(size.width, size.height) }),
    ...(nameBox && {
      name: { rel_pos: pair(nameBox.x, nameBox.y), size: pair(nameBox.width, nameBox.height) },
    }),
    ...(background !== undefined && {
      background_color: background === null ? false : tuple(background),
    }),
  };
}

/** The entry with more values in the part that belongs to the canvas. */
function merged(entry: LayoutEntry, more: LayoutEntry): LayoutEntry {
  const gui = asEntry(entry["gui"]);
  return {
    ...entry,
    gui: { ...gui, editor_gaphas: { ...asEntry(gui["editor_gaphas"]), ...more } },
  };
}

function asEntry(value: unknown): LayoutEntry {
  return value !== null && typeof value === "object" && !Array.isArray(value)
    ? (value as LayoutEntry)
    : {};
}

function pair(one: number, other: number): LayoutEntry {
  return tuple([rounded(one), rounded(other)]);
}

/** A tuple in the notation of the reference. */
function tuple(items: readonly number[]): LayoutEntry {
  return { __jsonqualname__: "__builtin__.tuple", items: [...items] };
}

/** Rounds away the digits that come only from arithmetic. */
export function rounded(value: number): number {
  return Number(value.toPrecision(9));
}

/** Layout of a state in another box, with everything on and in it scaled. */
export function scaledLayout(
  state: StateDocument,
  box: Box,
  factor: { readonly x: number; readonly y: number },
): LayoutDocument {
  const { nameBox, ports, waypoints } = readLayout(state);
  const at = (point: Point) => ({ x: point.x * factor.x, y: point.y * factor.y });
  return changed(state.layout, {
    position: box,
    size: box,
    nameBox: nameBox && scaledBox(nameBox, factor),
    ports: new Map([...ports].map(([key, point]) => [key, at(point)])),
    waypoints: new Map([...waypoints].map(([key, points]) => [key, points.map(at)])),
  });
}

export function scaledBox(box: Box, factor: { readonly x: number; readonly y: number }): Box {
  return {
    x: box.x * factor.x,
    y: box.y * factor.y,
    width: box.width * factor.x,
    height: box.height * factor.y,
  };
}
