/** The connections of one container as lines, in its coordinates: which ports they join, and by which way. */

import { type PortPlace, waypointsOf } from "../model/drawing.ts";
import { type ElementKey, keyOf } from "../model/element.ts";
import { type Box, type Point, type Size, sideOf } from "../model/geometry.ts";
import { dataFlowsOf, transitionsOf } from "../model/machine.ts";
import { childPath } from "../model/path.ts";
import { curve } from "./curve.ts";
import { type End, routed, type Wanted } from "./route.ts";
import type { PlacedState } from "./tree.ts";

/** A connection as it is drawn. */
export interface Line {
  readonly kind: "transition" | "data_flow";
  readonly id: number;
  readonly key: ElementKey;
  /** The ports that it joins. */
  readonly from: ElementKey;
  readonly to: ElementKey;
  /** The paths of their states. */
  readonly fromPath: string;
  readonly toPath: string;
  /** The name of the port where it begins; of a start nothing. */
  readonly label: string;
  /** The id of the outcome where it begins; of others 0. */
  readonly outcome: number;
  readonly points: readonly Point[];
  /** Which of the points are waypoints of the author. */
  readonly waypoints: readonly number[];
  /** The point after which it runs longest on its own: where a label sits best. */
  readonly longest: number;
  /** All that it touches. */
  readonly box: Box;
}

/** Lines that somebody holds: their waypoints as the gesture has them. */
export type Held = ReadonlyMap<ElementKey, readonly Point[]>;

/** The lines of a container. `kept` are those whose way is known; of these nothing is asked again. */
export function linesOf(
  container: PlacedState,
  held: Held,
  kept: ReadonlyMap<ElementKey, Line> = new Map(),
): readonly Line[] {
  const found = wantedOf(container, held);
  const open = found.filter(({ key }) => !kept.has(key));
  const ways = routed(
    open.filter(({ kind }) => kind === "transition"),
    container.children.map((child) => child.box),
    container.size,
    [...kept.values()].filter(({ kind }) => kind === "transition"),
  );
  const reach = reachOf(container);
  let next = 0;
  return found.map((wanted) => {
    const known = kept.get(wanted.key);
    if (known) return known;
    const way = wanted.kind === "transition" ? ways[next++] : undefined;
    return { ...wanted, ...(way ?? curve(wanted.start, wanted.goal, wanted.by, reach)) };
  });
}

/** How far data flows go out of their way. */
function reachOf({ size, children }: PlacedState): number {
  const sides = children.map(({ box }) => Math.min(box.width, box.height));
  return Math.min(
    0.15 * Math.min(size.width, size.height),
    0.8 * Math.max(...sides.slice(0, 64), 0),
  );
}

interface Found extends Wanted {
  readonly kind: "transition" | "data_flow";
  readonly id: number;
  readonly key: ElementKey;
  readonly fromPath: string;
  readonly toPath: string;
  readonly label: string;
  readonly outcome: number;
}

/** A port by its kind and id, and where it stands in the container. */
function endOf(
  container: PlacedState,
  owner: PlacedState,
  index: number,
  fits: (port: PortPlace) => boolean,
): { readonly end: End; readonly port: PortPlace; readonly path: string } | undefined {
  const port = owner.ports.find(fits);
  if (!port) return undefined;
  const inward = owner === container;
  const out = normal(port.at, owner.size, inward);
  const at = inward ? port.at : inContainer(owner, port.at);
  return { port, path: owner.path, end: { at, out, box: inward ? -1 : index } };
}

/** A point of a child in the coordinates of its container. */
function inContainer(child: PlacedState, at: Point): Point {
  return { x: child.box.x + at.x * child.scale, y: child.box.y + at.y * child.scale };
}

const NORMALS = {
  left: { x: -1, y: 0 },
  right: { x: 1, y: 0 },
  top: { x: 0, y: -1 },
  bottom: { x: 0, y: 1 },
} as const;

function normal(at: Point, size: Size, inward: boolean): Point {
  const { x, y } = NORMALS[sideOf(at, size)];
  return inward ? { x: -x || 0, y: -y || 0 } : { x, y };
}

function wantedOf(container: PlacedState, held: Held): readonly Found[] {
  const { state, path } = container;
  if (state.kind === "library") return [];
  const own = path.slice(path.lastIndexOf("/") + 1);
  const index = new Map(container.children.map((child, at) => [child.path, at]));
  const owner = (id: string | null | undefined): readonly [PlacedState, number] => {
    if (id === null || id === undefined || id === own) return [container, -1];
    const at = index.get(childPath(path, id)) ?? -1;
    return [container.children[at] ?? container, at];
  };
  const found: Found[] = [];
  const put = (
    kind: Found["kind"],
    id: number,
    from: ReturnType<typeof endOf>,
    to: ReturnType<typeof endOf>,
  ) => {
    if (!from || !to) return;
    const key = keyOf({ kind, path, id });
    found.push({
      kind,
      id,
      key,
      from: from.port.key,
      to: to.port.key,
      fromPath: from.path,
      toPath: to.path,
      label: from.port.kind === "income" ? "" : from.port.name,
      outcome: from.port.kind === "outcome" ? from.port.id : 0,
      start: from.end,
      goal: to.end,
      by: held.get(key) ?? waypointsOf(state, kind, id),
    });
  };
  const isIncome = (port: PortPlace) => port.kind === "income";
  for (const transition of transitionsOf(state)) {
    const [source, at] = owner(transition.from_state);
    const [target, to] = owner(transition.to_state);
    const outcome = (id: number | null | undefined) => (port: PortPlace) =>
      port.kind === "outcome" && port.id === id;
    const from = transition.from_state == null ? isIncome : outcome(transition.from_outcome);
    const goal = target === container ? outcome(transition.to_outcome) : isIncome;
    put(
      "transition",
      transition.id,
      endOf(container, source, at, from),
      endOf(container, target, to, goal),
    );
  }
  for (const flow of dataFlowsOf(state)) {
    const [source, at] = owner(flow.from_state);
    const [target, to] = owner(flow.to_state);
    const data = (id: number) => (port: PortPlace) =>
      port.id === id && port.kind !== "outcome" && port.kind !== "income";
    put(
      "data_flow",
      flow.id,
      endOf(container, source, at, data(flow.from_port)),
      endOf(container, target, to, data(flow.to_port)),
    );
  }
  return found;
}
