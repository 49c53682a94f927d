/** Incremental routing of the lines of a container, based on its previous lines. A line that joins the previous ports stays
 * unless something was added or removed beside it. */

import { type Box, boundsOf, type Point } from "../../model/geometry.ts";
import { type PortPlace, waypointsOf } from "../../model/layout_reader.ts";
import { dataFlowsOf, transitionsOf } from "../../model/machine.ts";
import { Grid, same, touches } from "../layout/grid.ts";
import type { LayoutNode } from "../layout/layout_node.ts";
import {
  type Joined,
  joined,
  LineEnds,
  type RoutedLine,
  type RoutedSource,
  reachOf,
  sourcesOf,
} from "../layout/lines.ts";
import { curve } from "./curve.ts";
import { nearFirst, routed } from "./route.ts";
import { paceOf, RoutingLanes } from "./routing_lanes.ts";

export class EdgeRouting {
  /** Lines found until now; after the last step all lines, in the machine's order. */
  known: readonly RoutedLine[] = [];
  /** True if the finished lines join exactly the ports that they joined before. */
  hasSameEnds = false;
  readonly #work: Iterator<undefined, void>;

  constructor(container: LayoutNode, before: LayoutNode | null) {
    this.#work = this.#wire(container, before && new PreviousLines(before, container));
  }

  /** Continues while `mayGoOn` allows it; returns true when all lines are found. */
  goOn(mayGoOn: () => boolean): boolean {
    while (mayGoOn()) if (this.#work.next().done) return true;
    return false;
  }

  *#wire(container: LayoutNode, previous: PreviousLines | null): Generator<undefined, void> {
    const ends = new LineEnds(container);
    const reach = reachOf(container);
    const all: (RoutedLine | null)[] = [];
    const open: Open[] = [];
    let isSame = previous !== null;
    for (const source of previous?.sources ?? sourcesOf(container.state)) {
      const before = previous?.line(source);
      if (before && previous?.stays(before)) {
        all.push(before);
        continue;
      }
      const found = joined(container, ends, source);
      isSame &&= before?.from === found?.from && before?.to === found?.to;
      if (!found) continue;
      const line = wayOf(found, before, previous, reach);
      if (!line) open.push({ ...found, index: all.length });
      all.push(line);
      yield;
    }
    this.hasSameEnds = isSame && previous?.lines.length === all.length;
    yield* this.#route(all, open, container);
  }

  /** Routes the transitions that are still open. */
  *#route(
    all: (RoutedLine | null)[],
    open: readonly Open[],
    { childGrid, size }: LayoutNode,
  ): Generator<undefined, void> {
    if (open.length > 0) {
      const ready = all.filter((line) => line !== null);
      this.known = ready;
      const lanes = new RoutingLanes(childGrid.boxes, size, childGrid);
      for (const { kind, points, to } of ready) if (kind === "transition") lanes.take(points, to);
      for (const { index, ...found } of nearFirst(open)) {
        const line = { ...found, ...routed(found, lanes) };
        all[index] = line;
        ready.push(line);
        yield;
      }
    }
    this.known = all as readonly RoutedLine[];
  }
}

/** A transition without a route, and its index in the list of lines. */
interface Open extends Joined {
  readonly index: number;
}

/** Line with its previous route, or with the curve of a data flow; null for a transition that needs a search. */
function wayOf(
  found: Joined,
  before: RoutedLine | undefined,
  previous: PreviousLines | null,
  reach: number,
): RoutedLine | null {
  if (before && previous?.keepsWay(before, found)) return { ...before, ...found };
  if (found.kind === "transition") return null;
  return { ...found, ...curve(found.start, found.goal, found.by, reach) };
}

/** Distance, in paces, at which an old box may have caused a detour, and at which a new box affects a route. */
const LED_AROUND = 2.3;
const NEAR = 0.5;

/** Previous lines of a container, and the boxes that changed since then. */
class PreviousLines {
  readonly lines: readonly RoutedLine[];
  /** Previous lines as the list of connections to draw, if the connections are unchanged. */
  readonly sources: readonly RoutedSource[] | null;
  readonly #container: LayoutNode;
  readonly #sameLayout: boolean;
  /** States with a changed position, size or set of ports. */
  readonly #moved = new Set<string>();
  /** Areas around boxes that were added, moved or removed. */
  readonly #places: Box[] = [];
  #grid: Grid | null = null;
  #bounds: Box | null = null;
  #next = 0;
  #byDocument: ReadonlyMap<object, RoutedLine> | null = null;

  constructor(before: LayoutNode, container: LayoutNode) {
    this.lines = before.lines;
    this.sources = isWhole(before, container) ? before.lines : null;
    this.#container = container;
    this.#sameLayout = before.state.layout === container.state.layout;
    const pace = paceOf(container.childGrid.boxes, container.size);
    if (!samePorts(before, container)) this.#moved.add(container.path);
    let sameOrder = before.children.length === container.children.length;
    container.children.forEach((child, index) => {
      const there = before.children[index];
      if (child === there) return;
      const stays = there?.path === child.path;
      sameOrder &&= stays;
      this.#compare(stays ? there : before.child(child.path), child, pace);
    });
    for (const gone of sameOrder ? [] : before.children) {
      if (container.indexOf(gone.path) < 0) this.#places.push(wider(gone.box, LED_AROUND * pace));
    }
    if (this.#places.length > 0) {
      this.#grid = new Grid(this.#places);
      this.#bounds = boundsOf(this.#places);
    }
  }

  #compare(was: LayoutNode | undefined, is: LayoutNode, pace: number): void {
    if (was && same(was.box, is.box) && was.scale === is.scale) {
      if (!samePorts(was, is)) this.#moved.add(is.path);
      return;
    }
    this.#moved.add(is.path);
    if (was) this.#places.push(wider(was.box, LED_AROUND * pace));
    this.#places.push(wider(is.box, NEAR * pace));
  }

  /** Previous line of a connection. Fast if called in the machine's order. */
  line({ document }: RoutedSource): RoutedLine | undefined {
    const next = this.lines[this.#next];
    if (next?.document === document) {
      this.#next++;
      return next;
    }
    this.#byDocument ??= new Map(this.lines.map((line) => [line.document, line]));
    const found = this.#byDocument.get(document);
    if (found) this.#next = this.lines.indexOf(found, this.#next) + 1;
    return found;
  }

  /** True if a line can stay unchanged. */
  stays(line: RoutedLine): boolean {
    if (this.#moved.has(line.fromPath) || this.#moved.has(line.toPath)) return false;
    const { kind, id, by } = line;
    if (!this.#sameLayout && !samePoints(waypointsOf(this.#container.state, kind, id), by)) {
      return false;
    }
    return this.#isClear(line);
  }

  /** True if a line keeps its route. Its ends may have new keys. */
  keepsWay(line: RoutedLine, now: Joined): boolean {
    const ends = samePoints(
      [line.start.at, line.start.out, line.goal.at, line.goal.out],
      [now.start.at, now.start.out, now.goal.at, now.goal.out],
    );
    return ends && line.to === now.to && samePoints(line.by, now.by) && this.#isClear(line);
  }

  /** True if no box changed beside the route of a transition that was routed automatically. */
  #isClear({ kind, by, box, points }: RoutedLine): boolean {
    const grid = this.#grid;
    if (!grid || !this.#bounds || kind === "data_flow" || by.length > 0) return true;
    if (!touches(box, this.#bounds)) return true;
    let clear = true;
    for (let index = 0; index + 1 < points.length && clear; index++) {
      const [one, other] = [points[index], points[index + 1]];
      if (one && other) grid.each(between(one, other), () => (clear = false));
    }
    return clear;
  }
}

/** True if the connections are unchanged, and each of them has a line. */
function isWhole({ state, lines }: LayoutNode, now: LayoutNode): boolean {
  const [transitions, flows] = [transitionsOf(state), dataFlowsOf(state)];
  return (
    transitions === transitionsOf(now.state) &&
    flows === dataFlowsOf(now.state) &&
    lines.length === transitions.length + flows.length
  );
}

function between(one: Point, other: Point): Box {
  const [x, y] = [Math.min(one.x, other.x), Math.min(one.y, other.y)];
  return { x, y, width: Math.abs(one.x - other.x), height: Math.abs(one.y - other.y) };
}

function wider({ x, y, width, height }: Box, by: number): Box {
  return { x: x - by, y: y - by, width: width + 2 * by, height: height + 2 * by };
}

function samePoints(some: readonly Point[], others: readonly Point[]): boolean {
  return (
    some.length === others.length &&
    some.every(({ x, y }, index) => x === others[index]?.x && y === others[index]?.y)
  );
}

function samePorts(one: LayoutNode, other: LayoutNode): boolean {
  return one.ports === other.ports || (sameSize(one, other) && samePlaces(one.ports, other.ports));
}

/** Compared because the side that a port is on depends on the size. */
function sameSize(one: LayoutNode, other: LayoutNode): boolean {
  return one.size.width === other.size.width && one.size.height === other.size.height;
}

function samePlaces(some: readonly PortPlace[], others: readonly PortPlace[]): boolean {
  return (
    some.length === others.length &&
    some.every(({ key, name, at }, index) => {
      const other = others[index];
      return (
        key === other?.key && name === other.name && at.x === other.at.x && at.y === other.at.y
      );
    })
  );
}
