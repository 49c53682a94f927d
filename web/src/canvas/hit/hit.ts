/** Hit test: finds the element under a point of the view. Elements too small to be drawn cannot be hit. Areas are generous, but
 * at most half the size of their state. The search goes from the root inwards, and visits only elements near the point. */

import { elementOf, keyOf } from "../../model/element.ts";
import { type Box, contains, distance, type Point } from "../../model/geometry.ts";
import type { PortPlace } from "../../model/layout_reader.ts";
import type { Machine } from "../../model/machine.ts";
import type { Camera } from "../../store/page/view.ts";
import { screenBox, screenFromWorld, worldFromScreen } from "../camera/camera.ts";
import { BREAKPOINT_REACH, breakpointSpot } from "../layout/breakpoint_spot.ts";
import type { Route } from "../layout/layout.ts";
import type { LayoutNode } from "../layout/layout_node.ts";
import { type LayoutTree, pointAt } from "../layout/layout_tree.ts";
import { DETAIL } from "../scene/detail.ts";
import { stickyFrame } from "../scene/sticky.ts";
import { distanceToLine, middlesOf } from "./lines.ts";
import type { CanvasHit, CanvasLook, CanvasPort, Grip, LineRef, StateRef } from "./look.ts";
import { childrenIn, inFrame, reachOf } from "./near.ts";
import { extentOn, isPortShown, isRouteShown } from "./shown.ts";

interface Search {
  readonly layout: LayoutTree;
  readonly machine: Machine;
  readonly look: CanvasLook;
  readonly camera: Camera;
  /** Point in CSS pixels of the view. */
  readonly point: Point;
  readonly tolerance: number;
}

/** Element at this point of the view, which is in CSS pixels; `tolerance` is the largest distance of a hit. */
export function hitAt(
  layout: LayoutTree,
  machine: Machine,
  look: CanvasLook,
  camera: Camera,
  point: Point,
  tolerance: number,
): CanvasHit | null {
  const search = { layout, machine, look, camera, point, tolerance };
  const line = statesAt(layout, machine, camera, point);
  const near = nearStates(search, line);
  const innermost = line.at(-1);
  return (
    endHit(search) ??
    stuckHit(search) ??
    gripHit(search, "corner") ??
    portHit(search, near) ??
    breakpointHit(search, near) ??
    gripHit(search, "side") ??
    (innermost === undefined ? null : insideHit(search, innermost)) ??
    outerLine(search, line)
  );
}

/** States that contain the point, from the root to the innermost one that is drawn. */
export function statesAt(
  layout: LayoutTree,
  machine: Machine,
  camera: Camera,
  point: Point,
): readonly string[] {
  const found: string[] = [];
  let next: string | undefined = isIn(layout, camera, point, machine.root)
    ? machine.root
    : undefined;
  while (next !== undefined) {
    found.push(next);
    const box = layout.box(next);
    const opens = box && extentOn(camera, box) >= DETAIL.content;
    next = opens
      ? childrenIn(layout, next, reachOf(camera, point, 0)).findLast((child) =>
          isIn(layout, camera, point, child),
        )
      : undefined;
  }
  return found;
}

function isIn(layout: LayoutTree, camera: Camera, point: Point, path: string): boolean {
  const box = layout.box(path);
  if (!box || extentOn(camera, box) < DETAIL.box) return false;
  return isNear(camera, box, point, 0);
}

function isNear(camera: Camera, box: Box, point: Point, reach: number): boolean {
  const left = (box.x - camera.x) * camera.scale;
  const top = (box.y - camera.y) * camera.scale;
  return (
    point.x >= left - reach &&
    point.y >= top - reach &&
    point.x <= left + box.width * camera.scale + reach &&
    point.y <= top + box.height * camera.scale + reach
  );
}

/** States with a border that may be within reach: those around the point, and their children beside it. */
function nearStates(search: Search, line: readonly string[]): readonly string[] {
  const { layout, machine, camera, point, tolerance } = search;
  const near = new Set<string>(line);
  const beside = (path: string) => {
    const box = layout.box(path);
    if (box && isNear(camera, box, point, tolerance * 2)) near.add(path);
  };
  if (line.length === 0) beside(machine.root);
  const area = reachOf(camera, point, tolerance * 2);
  for (const path of line) for (const child of childrenIn(layout, path, area)) near.add(child);
  return [...near];
}

function extentOf({ layout, camera }: Search, path: string): number {
  const box = layout.box(path);
  return box ? extentOn(camera, box) : 0;
}

/** Port of the container that fills the view, in the frame at the view's edges. */
function stuckHit({ layout, camera, look, point, tolerance }: Search): CanvasHit | null {
  const frame = stickyFrame(layout, camera, look.size);
  const found = frame?.ports.find(({ at }) => distance(at, point) <= tolerance * 1.5);
  const element = found && elementOf(found.port.key);
  if (!element) return null;
  return { on: "port", element: element as CanvasPort, at: worldFromScreen(camera, found.at) };
}

/** Nearest port. At equal distance the inner one wins. */
function portHit(search: Search, near: readonly string[]): CanvasHit | null {
  let best: { readonly path: string; readonly port: PortPlace; readonly away: number } | null =
    null;
  for (const path of near) {
    const size = extentOf(search, path);
    if (size < DETAIL.ports) continue;
    const reach = Math.min(search.tolerance * 1.5, size / 4);
    for (const port of search.layout.ports(path)) {
      const away = distance(screenFromWorld(search.camera, port.at), search.point);
      if (away > reach || (best && away > best.away)) continue;
      if (isPortShown(port, path, search)) best = { path, port, away };
    }
  }
  if (!best) return null;
  const element = elementOf(best.port.key);
  return element && { on: "port", element: element as CanvasPort, at: best.port.at };
}

/** Breakpoint dot on the border of a state. If several are within reach, the inner one wins. */
function breakpointHit(search: Search, near: readonly string[]): CanvasHit | null {
  const path = near.findLast((each) => {
    const box = search.layout.box(each);
    const at = box && breakpointSpot(screenBox(search.camera, box));
    return at != null && distance(at, search.point) <= BREAKPOINT_REACH;
  });
  return path === undefined ? null : { on: "breakpoint", element: { kind: "state", path } };
}

/** Reach of corners and sides, in CSS pixels. Corners take precedence over ports; sides come after them. */
const CORNER_REACH = 6;
const SIDE_REACH = 4;

/** Smallest size of a state that can be resized, in CSS pixels. Smaller ones can only be moved. */
const LEAST_FOR_GRIPS = 16;

/** Corner or side of a selected state. */
function gripHit(search: Search, part: "corner" | "side"): CanvasHit | null {
  for (const key of search.look.selection) {
    const element = elementOf(key);
    if (element?.kind !== "state" || search.machine.isInLibrary(element.path)) continue;
    const box = search.layout.box(element.path);
    const grip = box && gripAt(screenBox(search.camera, box), search.point);
    if (!grip || (part === "corner") !== (grip.length === 2)) continue;
    if (element.path === search.machine.root && /[nw]/.test(grip)) continue;
    return { on: "grip", element: element as StateRef, grip };
  }
  return null;
}

/** Corner or side of a box on the screen that is within reach. */
export function gripAt(box: Box, point: Point, reach = SIDE_REACH): Grip | null {
  const size = Math.min(box.width, box.height);
  if (size < LEAST_FOR_GRIPS) return null;
  const corner = Math.min(CORNER_REACH, size / 4);
  const side = Math.min(reach, size / 8);
  const x = nearest(point.x, box.x, box.x + box.width);
  const y = nearest(point.y, box.y, box.y + box.height);
  if (x.away <= corner && y.away <= corner) {
    return `${y.first ? "n" : "s"}${x.first ? "w" : "e"}`;
  }
  const within = { x: inside(point.x, box.x, box.width), y: inside(point.y, box.y, box.height) };
  if (x.away <= side && within.y) return x.first ? "w" : "e";
  if (y.away <= side && within.x) return y.first ? "n" : "s";
  return null;
}

function nearest(value: number, first: number, last: number) {
  const [one, other] = [Math.abs(value - first), Math.abs(value - last)];
  return { away: Math.min(one, other), first: one <= other };
}

function inside(value: number, start: number, length: number): boolean {
  return value >= start && value <= start + length;
}

/** Ends and waypoints of selected connections, which lie above everything. */
function endHit(search: Search): CanvasHit | null {
  for (const key of search.look.selection) {
    const element = elementOf(key);
    if (element?.kind !== "transition" && element?.kind !== "data_flow") continue;
    const route = routeOf(search.layout, element as LineRef);
    const found = route && onSelected(search, route, element as LineRef);
    if (found) return found;
  }
  return null;
}

/** Route of a connection, if it is drawn. */
export function routeOf(layout: LayoutTree, element: LineRef): Route | undefined {
  return layout
    .routes(element.path)
    .find((route) => route.kind === element.kind && route.id === element.id);
}

function onSelected(search: Search, route: Route, element: LineRef): CanvasHit | null {
  if (search.machine.isInLibrary(route.path)) return null;
  const waypoint = waypointHit(search, route, element);
  if (waypoint) return waypoint;
  const [first, last] = [route.points[0], route.points.at(-1)];
  const isAt = (at: Point | undefined) =>
    at !== undefined &&
    distance(screenFromWorld(search.camera, at), search.point) <= search.tolerance;
  if (isAt(last)) return { on: "end", element, end: "to" };
  return isAt(first) ? { on: "end", element, end: "from" } : middleHit(search, route, element);
}

function waypointHit(search: Search, route: Route, element: LineRef): CanvasHit | null {
  const index = route.waypoints.findIndex((corner) => {
    const at = route.points[corner];
    return at && distance(screenFromWorld(search.camera, at), search.point) <= search.tolerance;
  });
  return index < 0 ? null : { on: "waypoint", element, index };
}

function middleHit(search: Search, route: Route, element: LineRef): CanvasHit | null {
  const found = middlesOf(route).find(
    ({ at }) => distance(screenFromWorld(search.camera, at), search.point) <= search.tolerance,
  );
  return found ? { on: "middle", element, index: found.index } : null;
}

/** Element inside the innermost state at the point: a line, the name, or the state itself. */
function insideHit(search: Search, path: string): CanvasHit {
  const element = { kind: "state", path } as const;
  return lineHit(search, path) ?? nameHit(search, element) ?? { on: "state", element };
}

/** Lines outside of all states, which lead around the root. */
function outerLine(search: Search, line: readonly string[]): CanvasHit | null {
  return line.length > 0 ? null : lineHit(search, search.machine.root);
}

/** Number of states up to which lines are found immediately, even if the picture does not have them yet. */
const QUICKLY_ROUTED = 200;

/** Finds the lines of a small container. In a larger one, only lines that the picture already has can be hit. */
export function withLines(state: LayoutNode): LayoutNode {
  if (state.children.length <= QUICKLY_ROUTED) state.wire(() => true);
  return state;
}

/** Share of the tolerance that applies to lines. It is below 1 because many other targets are near lines. */
const LINE_SHARE = 0.75;

/** Nearest connection of a container. */
function lineHit(search: Search, path: string): CanvasHit | null {
  const frame = search.layout.frame(path);
  if (!frame || extentOf(search, path) < DETAIL.content) return null;
  const reach = search.tolerance * LINE_SHARE;
  const area = inFrame(frame, reachOf(search.camera, search.point, reach));
  let best: { readonly route: Route; readonly away: number } | null = null;
  withLines(frame.at).eachLine(area, ({ kind, id, points, waypoints }) => {
    const corners = points.map((point) => pointAt(frame, point));
    const away = distanceToLine(corners, search.point, search.camera);
    if (away > reach || (best && away >= best.away)) return;
    const route = { kind, path, id, points: corners, waypoints };
    if (isRouteShown(route, search)) best = { route, away };
  });
  return best && onLine(search, (best as { readonly route: Route }).route);
}

/** Line, or the waypoint or middle that can be dragged on it. */
function onLine(search: Search, route: Route): CanvasHit {
  const element: LineRef = { kind: route.kind, path: route.path, id: route.id };
  const line = { on: "line", element } as const;
  if (search.machine.isInLibrary(route.path)) return line;
  const isSelected = search.look.selection.has(keyOf(element));
  const middle = isSelected ? middleHit(search, route, element) : null;
  return waypointHit(search, route, element) ?? middle ?? line;
}

function nameHit(search: Search, element: StateRef): CanvasHit | null {
  const box = search.layout.box(element.path);
  if (!box || extentOf(search, element.path) < DETAIL.name) return null;
  const name = search.layout.name(element.path);
  const isSelected = search.look.selection.has(keyOf(element));
  if (name && isSelected) {
    const { x, y, width, height } = screenBox(search.camera, name);
    const corner = distance({ x: x + width, y: y + height }, search.point) <= search.tolerance;
    if (corner) return { on: "name", element, corner };
  }
  const isOpen = search.layout.children(element.path).length > 0;
  const area = nameArea(screenBox(search.camera, box), extentOf(search, element.path), isOpen);
  return contains(area, search.point) ? { on: "name", element, corner: false } : null;
}

/** Area of a state's name on the screen: at the top of large states, in the middle of others. */
export function nameArea(on: Box, extent: number, isOpen: boolean): Box {
  const height = Math.min(on.height, 26);
  if (extent < DETAIL.labels && !(isOpen && extent >= DETAIL.content)) {
    return { x: on.x, y: on.y + (on.height - height) / 2, width: on.width, height };
  }
  const [left, top] = [Math.max(on.x, 0), Math.max(on.y, 0)];
  return { x: left, y: top, width: Math.min(on.width, 220), height: height + 6 };
}
