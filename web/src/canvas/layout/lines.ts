/** Connections of one container, in its coordinates: the ports that they join, and their routes. */

import { type ElementKey, keyOf } from "../../model/element.ts";
import type {
  DataFlowDocument,
  StateDocument,
  TransitionDocument,
} from "../../model/generated/protocol.ts";
import { type Point, type Size, sideOf } from "../../model/geometry.ts";
import { type PortPlace, waypointsOf } from "../../model/layout_reader.ts";
import { dataFlowsOf, transitionsOf } from "../../model/machine.ts";
import { childPath, idOf } from "../../model/path.ts";
import type { Routed, RouteEnd, RouteRequest } from "../routing/route.ts";
import type { LayoutNode } from "./layout_node.ts";

/** A connection as in the machine's document. */
export interface RoutedSource {
  readonly kind: "transition" | "data_flow";
  readonly document: TransitionDocument | DataFlowDocument;
}

/** A connection with known ends. */
export interface Joined extends RouteRequest, RoutedSource {
  readonly id: number;
  readonly key: ElementKey;
  /** Keys of the ports that it joins. */
  readonly from: ElementKey;
  readonly to: ElementKey;
  /** Paths of the states of its ports. */
  readonly fromPath: string;
  readonly toPath: string;
  /** Name of the first port; empty for the start transition. */
  readonly label: string;
  /** Id of the outcome where it starts; 0 for other ports. */
  readonly outcome: number;
}

/** A connection with its route. */
export interface RoutedLine extends Joined, Routed {}

/** Largest detour of data flows in a container. */
export function reachOf({ size, children }: LayoutNode): number {
  const sides = children.map(({ box }) => Math.min(box.width, box.height));
  return Math.min(
    0.15 * Math.min(size.width, size.height),
    0.8 * Math.max(...sides.slice(0, 64), 0),
  );
}

/** A port, its position in the container, and the path of its state. */
interface Joint {
  readonly end: RouteEnd;
  readonly port: PortPlace;
  readonly path: string;
}

/** States that connections of a container can join, by id. */
export class LineEnds {
  readonly #container: LayoutNode;
  readonly #own: string;

  constructor(container: LayoutNode) {
    this.#container = container;
    this.#own = idOf(container.path);
  }

  isOwn(id: string | null | undefined): boolean {
    return id === null || id === undefined || id === this.#own;
  }

  /** A port of a child or of the container; undefined if it does not exist. */
  joint(id: string | null | undefined, fits: (port: PortPlace) => boolean): Joint | undefined {
    const isOwn = this.isOwn(id);
    const index = isOwn ? -1 : this.#container.indexOf(childPath(this.#container.path, id ?? ""));
    const owner = isOwn ? this.#container : this.#container.children[index];
    const port = owner?.ports.find(fits);
    if (!owner || !port) return undefined;
    const out = normal(port.at, owner.size, isOwn);
    const at = isOwn ? port.at : inContainer(owner, port.at);
    return { port, path: owner.path, end: { at, out, box: index } };
  }
}

/** Converts a point of a child to the coordinates of its container. */
function inContainer(child: LayoutNode, at: Point): Point {
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

/** All connections in a state, transitions first. */
export function sourcesOf(state: StateDocument): readonly RoutedSource[] {
  if (state.kind === "library") return [];
  return [
    ...transitionsOf(state).map((document) => ({ kind: "transition", document }) as const),
    ...dataFlowsOf(state).map((document) => ({ kind: "data_flow", document }) as const),
  ];
}

/** Connection with its ends; undefined if one of them is missing. */
export function joined(
  container: LayoutNode,
  ends: LineEnds,
  source: RoutedSource,
): Joined | undefined {
  const [from, to] = jointsOf(ends, source);
  if (!from || !to) return undefined;
  const { kind, document } = source;
  const { id } = document;
  const key = keyOf({ kind, path: container.path, id });
  return {
    kind,
    id,
    key,
    document,
    from: from.port.key,
    to: to.port.key,
    fromPath: from.path,
    toPath: to.path,
    label: from.port.kind === "income" ? "" : from.port.name,
    outcome: from.port.kind === "outcome" ? from.port.id : 0,
    start: from.end,
    goal: to.end,
    by: waypointsOf(container.state, kind, id),
  };
}

function jointsOf(ends: LineEnds, { document }: RoutedSource) {
  if ("from_port" in document) {
    const { from_state, from_port, to_state, to_port } = document;
    return [ends.joint(from_state, isData(from_port)), ends.joint(to_state, isData(to_port))];
  }
  const { from_state, from_outcome, to_state, to_outcome } = document;
  const source = from_state == null ? isIncome : isOutcome(from_outcome);
  const goal = ends.isOwn(to_state) ? isOutcome(to_outcome) : isIncome;
  return [ends.joint(from_state, source), ends.joint(to_state, goal)];
}

const isIncome = (port: PortPlace) => port.kind === "income";

const isOutcome = (id: number | null | undefined) => (port: PortPlace) =>
  port.kind === "outcome" && port.id === id;

const isData = (id: number) => (port: PortPlace) =>
  port.id === id && port.kind !== "outcome" && port.kind !== "income";
