/** Automatic layout: what elk is asked about each container, inner ones first, and what its answers come to. */

import type { ElkExtendedEdge, ElkNode, ElkPort, LayoutOptions } from "elkjs/lib/elk-api.js";
import { portPlaces } from "../model/drawing.ts";
import type { StateDocument, TransitionDocument } from "../model/generated/protocol.ts";
import { type Box, type Point, type Size, sideOf } from "../model/geometry.ts";
import { isContainer, type Machine, outcomesOf, transitionsOf } from "../model/machine.ts";
import { idOf } from "../model/path.ts";
import { childBoxes } from "./boxes.ts";

/** How one container is arranged, in units of its own. */
export interface Level {
  readonly size: Size;
  /** Where the name stands, above everything else. */
  readonly nameBox: Box;
  /** By the ids of the children. */
  readonly boxes: ReadonlyMap<string, Box>;
  /** Places of the ports of each child, as parts of its size, by their names in the file; of the container under its own id. */
  readonly ports: ReadonlyMap<string, ReadonlyMap<string, Point>>;
  /** Waypoints by the ids of the transitions; those without any are straight. */
  readonly ways: ReadonlyMap<number, readonly Point[]>;
}

/** What elk does: a graph without places in, the same with places out. */
export type Layouter = (graph: ElkNode) => Promise<ElkNode>;

/** Arranges a container, or all containers in it as well. */
export async function arrange(
  machine: Machine,
  container: string,
  deep: boolean,
  layout: Layouter,
): Promise<ReadonlyMap<string, Level>> {
  const levels = new Map<string, Level>();
  for (const path of deep ? containersIn(machine, container) : [container]) {
    const state = machine.state(path);
    if (!state || machine.children(path).length === 0) continue;
    const graph = elkGraph(machine, path, deep ? levels : null);
    levels.set(path, readLevel(state, await layout(graph)));
  }
  return levels;
}

/** Paths of the container and all inside it, inner ones first. */
function containersIn(machine: Machine, path: string): readonly string[] {
  const state = machine.state(path);
  if (!state || !isContainer(state)) return [];
  return [...machine.children(path).flatMap((child) => containersIn(machine, child)), path];
}

/** How large a state without content is drawn. */
const LEAF: Size = { width: 100, height: 60 };
const DECIDER: Size = { width: 80, height: 48 };

/** How large a container is drawn whose content would take so much: less, the more it is, since one looks into it anyway. */
export function outerSize({ width, height }: Size): Size {
  const part = Math.min(1, (LEAF.width / width) ** 0.35);
  return { width: width * part, height: height * part };
}

/** The graph of one container, wrapped, since elk places the ports of inner nodes only. With `levels` states get sizes by
 * their content, otherwise they keep those that they have. */
export function elkGraph(
  machine: Machine,
  path: string,
  levels: ReadonlyMap<string, Level> | null,
): ElkNode {
  const state = machine.state(path);
  if (!state) return { id: "", children: [] };
  const sizes = levels ? contentSizes(machine, path, levels) : childBoxes(machine, path);
  const lines = transitionsOf(state).filter(isDrawn);
  const children = machine.children(path).flatMap((child): ElkNode[] => {
    const size = sizes.get(child);
    const found = machine.state(child);
    return size && found ? [childNode(found, child, size, lines, levels?.get(child))] : [];
  });
  const unit = meanSide([...sizes.values()]) / meanSide([LEAF]);
  return {
    id: "",
    children: [
      {
        id: idOf(path),
        ports: ownPorts(state),
        children,
        edges: lines.flatMap((line) => edge(state, idOf(path), line, machine)),
        layoutOptions: levelOptions(unit),
      },
    ],
  };
}

function contentSizes(
  machine: Machine,
  path: string,
  levels: ReadonlyMap<string, Level>,
): ReadonlyMap<string, Size> {
  return new Map(
    machine.children(path).map((child) => {
      const level = levels.get(child);
      const leaf = machine.state(child)?.kind === "decider" ? DECIDER : LEAF;
      return [child, level ? outerSize(level.size) : leaf];
    }),
  );
}

function meanSide(sizes: readonly Size[]): number {
  const sum = sizes.reduce((total, { width, height }) => total + Math.sqrt(width * height), 0);
  return sum / Math.max(1, sizes.length);
}

/** Lines to aborted and preempted of the container come from everywhere: they are drawn as a bundle and shape nothing. */
function isDrawn({ to_outcome }: TransitionDocument): boolean {
  return to_outcome == null || to_outcome >= 0;
}

function levelOptions(unit: number): LayoutOptions {
  const units = (count: number) => String(count * unit);
  return {
    "elk.algorithm": "layered",
    "elk.direction": "RIGHT",
    "elk.edgeRouting": "ORTHOGONAL",
    "elk.portConstraints": "FIXED_SIDE",
    "elk.aspectRatio": "1.7",
    "elk.padding": `[top=${units(24)},left=${units(30)},bottom=${units(24)},right=${units(30)}]`,
    "elk.spacing.nodeNode": units(30),
    "elk.spacing.edgeNode": units(14),
    "elk.spacing.edgeEdge": units(8),
    "elk.spacing.componentComponent": units(36),
    "elk.layered.spacing.nodeNodeBetweenLayers": units(44),
    "elk.layered.spacing.edgeNodeBetweenLayers": units(16),
    "elk.layered.spacing.edgeEdgeBetweenLayers": units(8),
    "elk.layered.nodePlacement.strategy": "NETWORK_SIMPLEX",
    "elk.layered.considerModelOrder.strategy": "PREFER_EDGES",
    "elk.layered.feedbackEdges": "true",
    "elk.nodeSize.constraints": "PORTS",
  };
}

const SIDES: Readonly<Record<string, string>> = {
  left: "WEST",
  right: "EAST",
  top: "NORTH",
  bottom: "SOUTH",
};

function port(state: string, key: string, side: string, at?: Point): ElkPort {
  return {
    id: `${state}:${key}`,
    width: 0,
    height: 0,
    ...at,
    layoutOptions: { "elk.port.side": side },
  };
}

/** The ports of the container that lines inside it reach. */
function ownPorts(state: StateDocument): ElkPort[] {
  const id = idOf(state.path);
  const outcomes = outcomesOf(state).filter((outcome) => outcome.id >= 0);
  return [
    ...(state.kind === "hierarchy" ? [port(id, "income", "WEST")] : []),
    ...outcomes.map((outcome) => port(id, `outcome${outcome.id}`, "EAST")),
  ];
}

function childNode(
  state: StateDocument,
  path: string,
  size: Size,
  lines: readonly TransitionDocument[],
  level: Level | undefined,
): ElkNode {
  const id = idOf(path);
  const isFixed = isContainer(state);
  const used = lines.filter(({ from_state }) => from_state === id);
  const keys = used.map(({ from_outcome }) => `outcome${from_outcome}`);
  const known = isFixed ? knownPorts(state, path, size, level) : null;
  const ports = ["income", ...new Set(keys)].map((key) => {
    const at = known?.get(key);
    const side = at ? (SIDES[sideOf(at, size)] ?? "EAST") : freeSide(key);
    return port(id, key, side, at);
  });
  const constraints = isFixed ? "FIXED_POS" : "FIXED_SIDE";
  const { width, height } = size;
  return { id, width, height, ports, layoutOptions: { "elk.portConstraints": constraints } };
}

/** Errors leave below, everything else goes on to the right. */
function freeSide(key: string): string {
  if (key === "income") return "WEST";
  return key.startsWith("outcome-") ? "SOUTH" : "EAST";
}

/** Ports of a container stay where its inside has them. */
function knownPorts(
  state: StateDocument,
  path: string,
  size: Size,
  level: Level | undefined,
): ReadonlyMap<string, Point> {
  const inner = level?.ports.get(idOf(path));
  const places = portPlaces({ ...state, ...(level ? { layout: null } : {}) }, path, size);
  return new Map(
    places.flatMap(({ kind, id, at }): [string, Point][] => {
      if (kind !== "income" && kind !== "outcome") return [];
      const key = kind === "income" ? "income" : `outcome${id}`;
      const part = inner?.get(key) ?? (level ? errorPlace(id, kind) : undefined);
      return [[key, part ? { x: part.x * size.width, y: part.y * size.height } : at]];
    }),
  );
}

function errorPlace(id: number, kind: string): Point | undefined {
  if (kind !== "outcome" || id >= 0) return undefined;
  return { x: id === -1 ? 0.85 : 0.7, y: 1 };
}

const LETTER = 5;

function edge(
  state: StateDocument,
  own: string,
  line: TransitionDocument,
  machine: Machine,
): ElkExtendedEdge[] {
  const { id, from_state, from_outcome, to_state, to_outcome } = line;
  const source = from_state == null ? `${own}:income` : `${from_state}:outcome${from_outcome}`;
  const target = to_outcome == null ? `${to_state}:income` : `${own}:outcome${to_outcome}`;
  if (from_state == null && state.kind !== "hierarchy") return [];
  const name = outcomeName(machine, state, line);
  const labels = name ? [{ text: name, width: name.length * LETTER, height: 8 }] : [];
  return [{ id: `${id}`, sources: [source], targets: [target], labels }];
}

function outcomeName(
  machine: Machine,
  state: StateDocument,
  { from_state, from_outcome }: TransitionDocument,
): string {
  const child = from_state == null ? undefined : machine.state(`${state.path}/${from_state}`);
  return child ? (outcomesOf(child).find(({ id }) => id === from_outcome)?.name ?? "") : "";
}

/** Reads what elk says of a container, and makes room for its name above. */
function readLevel(state: StateDocument, answer: ElkNode): Level {
  const own = answer.children?.[0] ?? { id: "" };
  const [width, height] = [own.width ?? 1, own.height ?? 1];
  const by = { x: width * 0.02, y: Math.max(width, height) * 0.06 };
  const size = { width: width + 2 * by.x, height: height + by.y + width * 0.02 };
  const boxes = new Map<string, Box>();
  const ports = new Map([[own.id, ownParts(own, size, by)]]);
  for (const { id, x = 0, y = 0, width: w = 1, height: h = 1, ports: found } of own.children ??
    []) {
    boxes.set(id, { x: x + by.x, y: y + by.y, width: w, height: h });
    ports.set(id, parts(found ?? [], { width: w, height: h }));
  }
  const ways = new Map(transitionsOf(state).map(({ id }) => [id, way(own, id, by)]));
  const inset = by.y * 0.2;
  const nameBox = { x: inset, y: inset, width: size.width - 2 * inset, height: by.y };
  return { size, nameBox, boxes, ports, ways };
}

function keyIn(port: ElkPort): string {
  return port.id.slice(port.id.lastIndexOf(":") + 1);
}

function parts(ports: readonly ElkPort[], size: Size): ReadonlyMap<string, Point> {
  return new Map(
    ports.map((each) => [
      keyIn(each),
      { x: (each.x ?? 0) / size.width, y: (each.y ?? 0) / size.height },
    ]),
  );
}

/** The container's own ports stay on its sides though it became larger. */
function ownParts(own: ElkNode, size: Size, by: Point): ReadonlyMap<string, Point> {
  return new Map(
    (own.ports ?? []).map((each) => [
      keyIn(each),
      { x: keyIn(each) === "income" ? 0 : 1, y: ((each.y ?? 0) + by.y) / size.height },
    ]),
  );
}

function way(own: ElkNode, id: number, by: Point): readonly Point[] {
  const found = own.edges?.find((each) => each.id === `${id}`);
  const points = found?.sections?.flatMap(({ bendPoints }) => bendPoints ?? []) ?? [];
  return points.map(({ x, y }) => ({ x: x + by.x, y: y + by.y }));
}
