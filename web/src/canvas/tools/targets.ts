/** Possible ends of a connection: the visible ports, and the connection that each would make. */

import { type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import { distance, intersects, type Point } from "../../model/geometry.ts";
import type { Machine } from "../../model/machine.ts";
import { checkConnect } from "../../plan/connect.ts";
import { isRefused, type Refused, refused } from "../../plan/plan.ts";
import { screenFromWorld, visibleBox, worldFromScreen } from "../camera/camera.ts";
import type { CanvasPort } from "../hit/look.ts";
import { childrenIn } from "../hit/near.ts";
import { extentOn } from "../hit/shown.ts";
import { DETAIL } from "../scene/detail.ts";
import { stickyFrame } from "../scene/sticky.ts";
import type { ToolContext } from "./gesture.ts";

export interface VisiblePort {
  readonly element: CanvasPort;
  readonly name: string;
  /** Position in the root's coordinates. */
  readonly at: Point;
}

/** True for data ports. */
export function isData(element: ElementRef): boolean {
  return (
    element.kind === "input" || element.kind === "output" || element.kind === "scoped_variable"
  );
}

/** Visible ports of one kind, outer ones first. */
export function visiblePorts(context: ToolContext, data: boolean): readonly VisiblePort[] {
  const found: VisiblePort[] = [];
  collect(context.machine.root, data, context, found);
  const { layout, camera, size } = context;
  const stuck = stickyFrame(layout, camera, size);
  if (!stuck) return found;
  const frame = new Map(stuck.ports.map(({ port, at }) => [port.key, worldFromScreen(camera, at)]));
  return found.map((port) => ({ ...port, at: frame.get(keyOf(port.element)) ?? port.at }));
}

function collect(path: string, data: boolean, context: ToolContext, found: VisiblePort[]): void {
  const { layout, camera, size } = context;
  const box = layout.box(path);
  if (!box || extentOn(camera, box) < DETAIL.ports) return;
  if (!intersects(box, visibleBox(camera, size))) return;
  for (const port of layout.ports(path)) {
    const element = elementOf(port.key);
    if (element && isData(element) === data) {
      found.push({ element: element as CanvasPort, name: port.name, at: port.at });
    }
  }
  const seen = visibleBox(camera, size);
  for (const child of childrenIn(layout, path, seen)) collect(child, data, context, found);
}

/** Order in which the keyboard visits targets: the nearest first, those of the first state last. */
export function nearerTo(at: Point, own: string): (one: VisiblePort, other: VisiblePort) => number {
  const away = ({ at: there }: VisiblePort) => (there.x - at.x) ** 2 + (there.y - at.y) ** 2;
  const ownRank = ({ element }: VisiblePort) => (element.path === own ? 1 : 0);
  return (one, other) => ownRank(one) - ownRank(other) || away(one) - away(other);
}

export interface PortPair {
  readonly from: CanvasPort;
  readonly to: CanvasPort;
}

/** Connection between two ports in the legal direction, which may be opposite to the drawn one; or the reason why it is refused. */
export function endsBetween(
  machine: Machine,
  one: CanvasPort,
  other: CanvasPort,
): PortPair | Refused {
  if (isData(one) !== isData(other)) {
    return refused("A transition connects outcomes and incomes; a data flow connects data ports.");
  }
  const forth = checkConnect(machine, one, other);
  if (forth === true) return { from: one, to: other };
  const back = checkConnect(machine, other, one);
  return back === true ? { from: other, to: one } : forth;
}

/** Port nearest to the pointer, within reach. */
export function nearestPort(
  ports: readonly VisiblePort[],
  pointer: Point,
  context: ToolContext,
  reach: number,
): VisiblePort | null {
  let best: VisiblePort | null = null;
  let least = reach;
  for (const port of ports) {
    const away = distance(screenFromWorld(context.camera, port.at), pointer);
    if (away <= least) [best, least] = [port, away];
  }
  return best;
}

export function isLegal(ends: PortPair | Refused): ends is PortPair {
  return !isRefused(ends);
}
