/** The connections of one container as lines, in its coordinates: which ports they join, and by which way. */

import { type PortPlace, waypointsOf } from "../model/drawing.ts";
import { type ElementKey, keyOf } from "../model/element.ts";
import { type Box, type Point, type Size, sideOf } from "../model/geometry.ts";
import { dataFlowsOf, transitionsOf } from "../model/machine.ts";
import { childPath, idOf } from "../model/path.ts";
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

/** A port, where it stands in the container, and the path of its state. */
interface Joint {
  readonly end: End;
  readonly port: PortPlace;
  readonly path: string;
}

/** The states that connections of a container can join, by their ids. */
class Ends {
  readonly #container: PlacedState;
  readonly #own: string;
  readonly #index: ReadonlyMap<string, number>;

  constructor(container: PlacedState) {
    this.#container = container;
    this.#own = idOf(container.path);
    this.#index = new Map(container.children.map((child, at) => [child.path, at]));
  }

  isOwn(id: string | null | undefined): boolean {
    return id === null || id === undefined || id === this.#own;
  }

  /** The port of a child, or of the container; undefined if there is none such. */
  joint(id: string | null | undefined, fits: (port: PortPlace) => boolean): Joint | undefined {
    const isOwn = this.isOwn(id);
    const index = isOwn ? -1 : (this.#index.get(childPath(this.#container.path, id ?? "")) ?? -1);
    const owner = isOwn ? this.#container : this.#container.children[index];
    const port = owner?.ports.find(fits);
    if (!owner || !port) return undefined;
    const out = normal(port.at, owner.size, isOwn);
    const at = isOwn ? port.at : inContainer(owner, port.at);
    return { port, path: owner.path, end: { at, out, box: index } };
  }
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
  const ends = new Ends(container);
  const found: Found[] = [];
  const put = (kind: Found["kind"], id: number, from: Joint | undefined, to: Joint | undefined) => {
    if (!from || !to) return;
    const key = keyOf({ kind, path, id });
    const by = held.get(key) ?? waypointsOf(state, kind, id);
    found.push(foundOf(kind, id, key, from, to, by));
  };
  for (const { id, ...transition } of transitionsOf(state)) {
    const starts = transition.from_state == null;
    const source = starts ? isIncome : isOutcome(transition.from_outcome);
    const goal = ends.isOwn(transition.to_state) ? isOutcome(transition.to_outcome) : isIncome;
    const from = ends.joint(transition.from_state, source);
    put("transition", id, from, ends.joint(transition.to_state, goal));
  }
  for (const { id, ...flow } of dataFlowsOf(state)) {
    const from = ends.joint(flow.from_state, isData(flow.from_port));
    put("data_flow", id, from, ends.joint(flow.to_state, isData(flow.to_port)));
  }
  return found;
}

function foundOf(
  kind: Found["kind"],
  id: number,
  key: ElementKey,
  from: Joint,
  to: Joint,
  by: readonly Point[],
): Found {
  return {
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
    by,
  };
}

const isIncome = (port: PortPlace) => port.kind === "income";

const isOutcome = (id: number | null | undefined) => (port: PortPlace) =>
  port.kind === "outcome" && port.id === id;

const isData = (id: number) => (port: PortPlace) =>
  port.id === id && port.kind !== "outcome" && port.kind !== "income";
