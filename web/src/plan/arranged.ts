/** The edit of an automatic layout. */

import type { Edit, StateDocument } from "../model/generated/protocol.ts";
import type { Box, Point, Size } from "../model/geometry.ts";
import { changed, type LayoutChange, scaledLayout } from "../model/layout.ts";
import { readLayout } from "../model/layout_reader.ts";
import type { Machine } from "../model/machine.ts";
import { childPath, idOf, parentOf } from "../model/path.ts";
import type { Level } from "./arrange.ts";
import { boxIn } from "./boxes.ts";
import { containerAt } from "./legal.ts";
import { isRefused, type Planned, refused, together } from "./plan.ts";
import { scaleInside } from "./resize.ts";

/** Puts everything in a container where `arrange` has found places. The root becomes as large as it has to be; in any other
 * container the content is made to fit. */
export function arranged(
  machine: Machine,
  container: string,
  levels: ReadonlyMap<string, Level>,
): Planned {
  const state = containerAt(machine, container);
  if (isRefused(state)) return state;
  const level = levels.get(container);
  if (!level) return refused(`${state.name} contains nothing to arrange yet.`);
  const isRoot = parentOf(container) === null;
  const box = isRoot ? { ...boxIn(machine, container), ...level.size } : boxIn(machine, container);
  const edits = new Arranging(machine, levels).container(state, container, box, box, null);
  return { name: "Automatic layout", edit: together(edits) };
}

class Arranging {
  readonly #machine: Machine;
  readonly #levels: ReadonlyMap<string, Level>;

  constructor(machine: Machine, levels: ReadonlyMap<string, Level>) {
    this.#machine = machine;
    this.#levels = levels;
  }

  /** The container with its lines, then its content. */
  container(
    state: StateDocument,
    path: string,
    box: Box,
    size: Size,
    outer: ReadonlyMap<string, Point> | null,
  ): Edit[] {
    const level = this.#levels.get(path);
    if (!level) return this.#leaf(state, path, box, outer);
    const into = fitting(level.size, size);
    const own = level.ports.get(idOf(path)) ?? new Map<string, Point>();
    const ports = new Map([
      ...onSides(own, level, into, size),
      ...(outer ? inSize(outer, size) : []),
    ]);
    const change: LayoutChange = {
      nameBox: { ...into(level.nameBox), ...scaled(level.nameBox, into) },
      ports,
      waypoints: this.#waypoints(state, level, into),
    };
    const base = scaledLayout(state, box, factorOf(boxIn(this.#machine, path), box));
    const edits: Edit[] = [{ edit: "set_layout", path, layout: changed(base, change) }];
    for (const [id, inner] of level.boxes) {
      const child = childPath(path, id);
      const found = this.#machine.state(child);
      if (!found) continue;
      const place = { ...into(inner), ...scaled(inner, into) };
      edits.push(...this.container(found, child, place, place, level.ports.get(id) ?? null));
    }
    return edits;
  }

  #leaf(
    state: StateDocument,
    path: string,
    box: Box,
    ports: ReadonlyMap<string, Point> | null,
  ): Edit[] {
    const factor = factorOf(boxIn(this.#machine, path), box);
    const [first, ...rest] = scaleInside(this.#machine, path, box, factor);
    const base = first?.edit === "set_layout" ? first.layout : state.layout;
    const layout = changed(base, { ports: ports ? inSize(ports, box) : undefined });
    return [{ edit: "set_layout", path, layout }, ...rest];
  }

  #waypoints(
    state: StateDocument,
    level: Level,
    into: Into,
  ): ReadonlyMap<string, readonly Point[]> {
    const before = readLayout(state).waypoints;
    const waypoints = new Map<string, readonly Point[]>([...before.keys()].map((key) => [key, []]));
    for (const [id, points] of level.routes) {
      const key = `transition${id}`;
      if (points.length > 0 || before.has(key)) waypoints.set(key, points.map(into));
    }
    return waypoints;
  }
}

type Into = (at: Point) => Point;

/** From the units of a level into a box of this size, as large as it goes and in the middle. */
function fitting(level: Size, size: Size): Into {
  const factor = Math.min(size.width / level.width, size.height / level.height);
  const left = (size.width - level.width * factor) / 2;
  const top = (size.height - level.height * factor) / 2;
  return ({ x, y }) => ({ x: x * factor + left, y: y * factor + top });
}

function scaled({ width, height }: Size, into: Into): Size {
  const [start, end] = [into({ x: 0, y: 0 }), into({ x: width, y: height })];
  return { width: end.x - start.x, height: end.y - start.y };
}

function factorOf(before: Size, now: Size): Point {
  return { x: now.width / before.width, y: now.height / before.height };
}

function inSize(ports: ReadonlyMap<string, Point>, size: Size): ReadonlyMap<string, Point> {
  return new Map([...ports].map(([key, part]) => [key, at(part, size)]));
}

function at(part: Point, size: Size): Point {
  return { x: part.x * size.width, y: part.y * size.height };
}

/** The container's ports at the height of the lines that lead to them, on its sides. */
function onSides(
  ports: ReadonlyMap<string, Point>,
  level: Level,
  into: Into,
  size: Size,
): ReadonlyMap<string, Point> {
  return new Map(
    [...ports].map(([key, part]) => {
      const inside = into(at(part, level.size));
      return [key, { x: part.x * size.width, y: inside.y }];
    }),
  );
}
