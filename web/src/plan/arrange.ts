/** Automatic layout: the requests to elk for each container, inner ones first, and the resulting positions. */

import type { ElkExtendedEdge, ElkNode, ElkPort, LayoutOptions } from "elkjs/lib/elk-api.js";
import type { StateDocument, TransitionDocument } from "../model/generated/protocol.ts";
import type { Box, Point, Size } from "../model/geometry.ts";
import { isContainer, type Machine, outcomesOf, startOf, transitionsOf } from "../model/machine.ts";
import { childPath, idOf } from "../model/path.ts";
import { childBoxes } from "./boxes.ts";
import { isExactlyRightAngled } from "./right_angles.ts";

/** Layout of one container, in its own units. */
export interface Level {
  readonly size: Size;
  /** Space for the name above the content. */
  readonly nameBox: Box;
  /** By the ids of the children. */
  readonly boxes: ReadonlyMap<string, Box>;
  /** Places of the ports of each child, as parts of its size, by their names in the file. */
  readonly ports: ReadonlyMap<string, ReadonlyMap<string, Point>>;
  /** Waypoints by the ids of the transitions; those without any are straight. */
  readonly routes: ReadonlyMap<number, readonly Point[]>;
}

/** The function of elk: adds positions to a graph. */
export type Layouter = (graph: ElkNode) => Promise<ElkNode>;

/** Caller of an arrangement, which may cancel it. */
export interface Progress {
  readonly isCancelled: () => boolean;
  readonly report: (now: {
    readonly states: number;
    readonly levelsDone: number;
    readonly levels: number;
  }) => void;
}

const UNWATCHED: Progress = { isCancelled: () => false, report: () => {} };

/** Arranges a container, or all containers in it as well. Fails if it is cancelled. */
export async function arrange(
  machine: Machine,
  container: string,
  deep: boolean,
  layout: Layouter,
  progress = UNWATCHED,
): Promise<ReadonlyMap<string, Level>> {
  const levels = new Map<string, Level>();
  const wanted = (deep ? containersIn(machine, container) : [container]).filter(
    (path) => machine.children(path).length > 0,
  );
  const states = wanted.reduce((sum, path) => sum + machine.children(path).length, 0);
  const report = () => progress.report({ states, levelsDone: levels.size, levels: wanted.length });
  report();
  for (const path of wanted) {
    const state = machine.state(path);
    if (!state) continue;
    const graph = elkGraph(machine, path, deep ? levels : null);
    levels.set(path, readLevel(state, await laidOut(graph, layout, progress)));
    if (progress.isCancelled()) throw new Error("the layout was cancelled");
    report();
  }
  return levels;
}

/** The answer of elk. Of some graphs with loops it cannot break long rows: those stay long. */
async function laidOut(graph: ElkNode, layout: Layouter, progress: Progress): Promise<ElkNode> {
  const rows = { ...graph.layoutOptions, "elk.layered.wrapping.strategy": "OFF" };
  try {
    return await layout(graph);
  } catch (error) {
    if (progress.isCancelled()) throw error;
    return layout({ ...graph, layoutOptions: rows });
  }
}

/** Paths of the container and all inside it, inner ones first. */
function containersIn(machine: Machine, path: string): readonly string[] {
  const state = machine.state(path);
  if (!state || !isContainer(state)) return [];
  return [...machine.children(path).flatMap((child) => containersIn(machine, child)), path];
}

/** Size of a state without content. */
const LEAF: Size = { width: 100, height: 60 };
const DECIDER: Size = { width: 80, height: 48 };

/** Size of a container by the size of its content. It grows less than the content, because users zoom into it. */
function outerSize({ width, height }: Size): Size {
  const part = Math.min(1, (LEAF.width / width) ** 0.25);
  return { width: width * part, height: height * part };
}

/** The graph of one container, without the lines from its income and to its outcomes, which find their way by themselves.
 * With `levels` states get sizes by their content, otherwise they keep those that they have. */
export function elkGraph(
  machine: Machine,
  path: string,
  levels: ReadonlyMap<string, Level> | null,
): ElkNode {
  const state = machine.state(path);
  if (!state) return { id: path };
  const sizes = levels ? contentSizes(machine, path, levels) : childBoxes(machine, path);
  const lines = transitionsOf(state).filter(isBetween);
  const start = startOf(state)?.to_state;
  const children = machine.children(path).flatMap((child): ElkNode[] => {
    const size = sizes.get(child);
    const found = machine.state(child);
    return size && found ? [childNode(found, child, size, lines, start === idOf(child))] : [];
  });
  const unit = meanSide([...sizes.values()]) / meanSide([LEAF]);
  const edges = lines.map((line) => edge(machine, path, line));
  return { id: path, children, edges, layoutOptions: levelOptions(unit) };
}

/** Smallest size of a state relative to the largest one of its container, so that all names are readable. */
const PART = 0.35;

function contentSizes(
  machine: Machine,
  path: string,
  levels: ReadonlyMap<string, Level>,
): ReadonlyMap<string, Size> {
  const wanted = machine.children(path).map((child): readonly [string, Size] => {
    const level = levels.get(child);
    const leaf = machine.state(child)?.kind === "decider" ? DECIDER : LEAF;
    return [child, level ? outerSize(level.size) : leaf];
  });
  const largest = Math.max(...wanted.map(([, { width }]) => width));
  return new Map(
    wanted.map(([child, { width, height }]) => {
      const factor = Math.max(1, (largest * PART) / width);
      return [child, { width: width * factor, height: height * factor }];
    }),
  );
}

function meanSide(sizes: readonly Size[]): number {
  const sum = sizes.reduce((total, { width, height }) => total + Math.sqrt(width * height), 0);
  return sum / Math.max(1, sizes.length);
}

function isBetween({ from_state, to_outcome }: TransitionDocument): boolean {
  return from_state != null && to_outcome == null;
}

function levelOptions(unit: number): LayoutOptions {
  const units = (count: number) => String(count * unit);
  return {
    "elk.algorithm": "layered",
    "elk.direction": "RIGHT",
    "elk.edgeRouting": "ORTHOGONAL",
    "elk.aspectRatio": "1.6",
    "elk.layered.thoroughness": "3",
    "elk.layered.wrapping.strategy": "MULTI_EDGE",
    "elk.layered.wrapping.additionalEdgeSpacing": units(4),
    "elk.padding": `[top=${units(8)},left=${units(14)},bottom=${units(14)},right=${units(14)}]`,
    "elk.spacing.nodeNode": units(18),
    "elk.spacing.edgeNode": units(8),
    "elk.spacing.edgeEdge": units(5),
    "elk.spacing.componentComponent": units(20),
    "elk.layered.spacing.nodeNodeBetweenLayers": units(26),
    "elk.layered.spacing.edgeNodeBetweenLayers": units(9),
    "elk.layered.spacing.edgeEdgeBetweenLayers": units(5),
    "elk.layered.nodePlacement.strategy": "BRANDES_KOEPF",
    "elk.layered.considerModelOrder.strategy": "PREFER_EDGES",
    "elk.layered.feedbackEdges": "true",
  };
}

function childNode(
  state: StateDocument,
  path: string,
  { width, height }: Size,
  lines: readonly TransitionDocument[],
  isStart: boolean,
): ElkNode {
  const id = idOf(path);
  const used = lines.filter(({ from_state }) => from_state === id);
  const shown = outcomesOf(state).filter(
    (outcome) => outcome.id >= 0 || used.some(({ from_outcome }) => from_outcome === outcome.id),
  );
  const ports = [
    port(`${id}:income`, "WEST"),
    ...shown.map((outcome) => port(outcomePort(id, outcome.id), side(outcome.id))),
  ];
  const layoutOptions = {
    "elk.portConstraints": "FIXED_SIDE",
    ...(isStart ? { "elk.layered.layering.layerConstraint": "FIRST" } : {}),
  };
  return { id, width, height, ports, layoutOptions };
}

function outcomePort(state: string, outcome: number): string {
  return `${state}:outcome${outcome}`;
}

/** Error transitions leave at the bottom, all others on the right. */
function side(outcome: number): string {
  return outcome < 0 ? "SOUTH" : "EAST";
}

function port(id: string, side: string): ElkPort {
  return { id, width: 0, height: 0, layoutOptions: { "elk.port.side": side } };
}

/** Width and height of a letter of a label, for the space between states. */
const LETTER: Size = { width: 5, height: 8 };

function edge(machine: Machine, container: string, line: TransitionDocument): ElkExtendedEdge {
  const { id, from_state, from_outcome, to_state } = line;
  const child = machine.state(childPath(container, from_state ?? ""));
  const text = child && outcomesOf(child).find((outcome) => outcome.id === from_outcome)?.name;
  const labels = text ? [{ text, width: text.length * LETTER.width, height: LETTER.height }] : [];
  return {
    id: `${id}`,
    sources: [outcomePort(from_state ?? "", from_outcome ?? 0)],
    targets: [`${to_state}:income`],
    labels,
  };
}

/** Reads elk's result for a container, with space for the name above. */
function readLevel(state: StateDocument, answer: ElkNode): Level {
  const { width = 1, height = 1, children = [] } = answer;
  const by = { x: width * 0.02, y: Math.max(height * 0.13, width * 0.05) };
  const size = { width: width + 2 * by.x, height: height + by.y + width * 0.02 };
  const boxes = new Map<string, Box>();
  const ports = new Map<string, ReadonlyMap<string, Point>>();
  for (const { id, x = 0, y = 0, width: w = 1, height: h = 1, ports: found } of children) {
    boxes.set(id, { x: x + by.x, y: y + by.y, width: w, height: h });
    ports.set(id, parts(found ?? [], { width: w, height: h }));
  }
  const routes = new Map(transitionsOf(state).map(({ id }) => [id, routePoints(answer, id, by)]));
  const inset = by.y * 0.2;
  const nameBox = { x: inset, y: inset, width: size.width - 2 * inset, height: by.y };
  return { size, nameBox, boxes, ports, routes };
}

function parts(ports: readonly ElkPort[], size: Size): ReadonlyMap<string, Point> {
  return new Map(
    ports.map(({ id, x = 0, y = 0 }) => [
      id.slice(id.lastIndexOf(":") + 1),
      { x: x / size.width, y: y / size.height },
    ]),
  );
}

/** Bends of a line. Of long rows that it breaks, elk loses bends of some lines: those find their way by themselves. */
function routePoints(answer: ElkNode, id: number, by: Point): readonly Point[] {
  const found = answer.edges?.find((each) => each.id === `${id}`);
  const points = found?.sections?.flatMap(({ bendPoints }) => bendPoints ?? []) ?? [];
  if (!found || points.length === 0) return [];
  const [start, goal] = [found.sources[0], found.targets[0]].map((port) => portAt(answer, port));
  const isWhole = start && goal && isExactlyRightAngled([start, ...points, goal]);
  return isWhole ? points.map(({ x, y }) => ({ x: x + by.x, y: y + by.y })) : [];
}

/** Position of a port in the container. */
function portAt({ children = [] }: ElkNode, id: string | undefined): Point | null {
  for (const { x = 0, y = 0, ports = [] } of children) {
    const found = ports.find((port) => port.id === id);
    if (found) return { x: x + (found.x ?? 0), y: y + (found.y ?? 0) };
  }
  return null;
}
