/** Steps of a machine as a tree, and as rows for display: the newest first, each branch in its own lane. */

import type { MachineStep, MachineSteps } from "./generated/protocol.ts";

/** A past or current version of the machine. */
export interface StepNode {
  readonly revision: number;
  /** Step that created it; null for the machine as it was loaded. */
  readonly step: MachineStep | null;
  /** Previous node; null for the first known one. */
  readonly parent: number | null;
}

interface StepTree {
  readonly nodes: ReadonlyMap<number, StepNode>;
  /** Current node. */
  readonly current: number;
}

export function stepTree({ start, steps }: MachineSteps): StepTree {
  const nodeOf = new Map<number, number>([[start, start]]);
  const nodes = new Map<number, StepNode>();
  nodes.set(start, { revision: start, step: null, parent: null });
  let current = start;
  for (const step of steps) {
    const { revision } = step;
    const before = nodeOf.get(revision - 1) ?? null;
    current = step.same_as ?? revision;
    nodeOf.set(revision, current);
    if (!nodes.has(current)) nodes.set(current, { revision: current, step, parent: before });
  }
  return { nodes, current };
}

/** Relation of a step to the current node: equal, before it, undone after it, or on another branch. */
type StepPlace = "current" | "done" | "undone" | "branch";

export interface StepRow {
  readonly node: StepNode;
  readonly place: StepPlace;
  readonly lane: number;
  /** Lanes with a line through the row, above and below its middle. */
  readonly above: readonly number[];
  readonly below: readonly number[];
  /** Lanes of branches that begin at this node. Their lines bend to its lane. */
  readonly joins: readonly number[];
}

/** Rows, the newest node first; without branches only those on the current path. */
export function stepRows(tree: StepTree, hasBranches: boolean): readonly StepRow[] {
  const places = placesOf(tree);
  const nodes = [...tree.nodes.values()]
    .filter(({ revision }) => hasBranches || places.get(revision) !== "branch")
    .sort((one, other) => other.revision - one.revision);
  const heirs = heirsOf(nodes, places);
  const lanes = new Map<number, number>();
  let open = new Map<number, number>();
  return nodes.map((node): StepRow => {
    const { revision, parent } = node;
    const joining = [...open].filter(([, end]) => end === revision).map(([lane]) => lane);
    const lane = lanes.get(heirs.get(revision) ?? revision) ?? freeLane(open, places, revision);
    lanes.set(revision, lane);
    const above = [...open.keys()];
    const left = new Map([...open].filter(([other]) => !joining.includes(other)));
    if (parent !== null) left.set(lane, parent);
    open = left;
    const joins = joining.filter((other) => other !== lane);
    const below = [...open.keys()];
    return { node, place: places.get(revision) ?? "branch", lane, above, below, joins };
  });
}

function placesOf({ nodes, current }: StepTree): ReadonlyMap<number, StepPlace> {
  const places = new Map<number, StepPlace>();
  for (let at = nodes.get(current); at; at = nodes.get(at.parent ?? -1)) {
    places.set(at.revision, at.revision === current ? "current" : "done");
  }
  for (const { revision, parent } of [...nodes.values()].sort(byRevision)) {
    if (places.has(revision)) continue;
    const before = parent === null ? undefined : places.get(parent);
    const isUndone = before === "current" || before === "undone";
    places.set(revision, isUndone ? "undone" : "branch");
  }
  return places;
}

/** Child that continues in the lane of its parent: the one on the path to the current node, otherwise the newest. */
function heirsOf(
  nodes: readonly StepNode[],
  places: ReadonlyMap<number, StepPlace>,
): ReadonlyMap<number, number> {
  const heirs = new Map<number, number>();
  for (const { revision, parent } of nodes) {
    if (parent === null) continue;
    const place = places.get(revision);
    const isOnTheWay = place === "current" || place === "done";
    if (isOnTheWay || !heirs.has(parent)) heirs.set(parent, revision);
  }
  return heirs;
}

/** The first lane is reserved for the current path. */
function freeLane(
  open: ReadonlyMap<number, number>,
  places: ReadonlyMap<number, StepPlace>,
  revision: number,
): number {
  if (places.get(revision) !== "branch" && !open.has(0)) return 0;
  let lane = 1;
  while (open.has(lane)) lane += 1;
  return lane;
}

function byRevision(one: StepNode, other: StepNode): number {
  return one.revision - other.revision;
}
