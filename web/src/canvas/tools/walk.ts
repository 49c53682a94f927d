/** Navigation by keyboard: along transitions and data flows, into and out of states, from port to port. */

import { type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import { endsOf, flowEnds, isConnection, transitionEnds } from "../../model/ends.ts";
import { centre } from "../../model/geometry.ts";
import { dataFlowsOf, type Machine, startOf, transitionsOf } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import type { Layout } from "../layout/layout.ts";

export type Direction = "next" | "previous" | "in" | "out";

/** Next element in a direction; null if there is none. */
export function walked(
  machine: Machine,
  layout: Layout,
  from: ElementRef,
  direction: Direction,
): ElementRef | null {
  switch (direction) {
    case "in":
      return from.kind === "state" ? entrance(machine, layout, from.path) : null;
    case "out":
      return outwards(from);
    default:
      return along(machine, layout, from, direction);
  }
}

/** Target of the container's start transition, or else its first child. */
export function entrance(machine: Machine, layout: Layout, path: string): ElementRef | null {
  const state = machine.state(path);
  const start = state && startOf(state);
  const to = start && transitionEnds(path, start).to;
  if (to && to.path !== path && layout.box(to.path)) return { kind: "state", path: to.path };
  const [first] = layout.children(path);
  return first === undefined ? null : { kind: "state", path: first };
}

function outwards(from: ElementRef): ElementRef | null {
  if (from.kind !== "state") return { kind: "state", path: from.path };
  const parent = parentOf(from.path);
  return parent === null ? null : { kind: "state", path: parent };
}

function along(
  machine: Machine,
  layout: Layout,
  from: ElementRef,
  direction: "next" | "previous",
): ElementRef | null {
  if (isConnection(from)) {
    const ends = endsOf(machine, from);
    return ends && settled(direction === "next" ? ends.to : ends.from, from.path);
  }
  const linked = neighbours(machine, from, direction);
  if (linked) return linked;
  return from.kind === "state" ? beside(layout, from.path, direction) : null;
}

/** Replaces the income of a state by the state. Ports of the container stay. */
function settled(end: ElementRef, container: string): ElementRef {
  return end.kind === "income" && end.path !== container ? { kind: "state", path: end.path } : end;
}

/** Element at the other end of the first connection from or to the element. */
function neighbours(
  machine: Machine,
  from: ElementRef,
  direction: "next" | "previous",
): ElementRef | null {
  const [near, far] = direction === "next" ? (["from", "to"] as const) : (["to", "from"] as const);
  for (const container of containersOf(from)) {
    const state = machine.state(container);
    if (!state) continue;
    const transitions = [...transitionsOf(state)]
      .sort((one, other) => rank(one.from_outcome) - rank(other.from_outcome))
      .map((one) => transitionEnds(container, one));
    const flows =
      from.kind === "state"
        ? []
        : dataFlowsOf(state).flatMap((one) => flowEnds(machine, container, one) ?? []);
    const found = [...transitions, ...flows].find((ends) => isAt(ends[near], from, container));
    if (!found) continue;
    const end = found[far];
    if (from.kind !== "state" || end.path === container) return settled(end, container);
    return { kind: "state", path: end.path };
  }
  return null;
}

/** Sort key: outcomes of a success before aborted and preempted. */
function rank(outcome: number | null | undefined): number {
  return outcome == null ? 0 : outcome < 0 ? 1000 - outcome : outcome;
}

/** Containers with connections of the element: the container around its state, and for a port also the state itself. */
function containersOf(from: ElementRef): readonly string[] {
  const parent = parentOf(from.path);
  if (from.kind === "state") return parent === null ? [] : [parent];
  return parent === null ? [from.path] : [parent, from.path];
}

function isAt(end: ElementRef, from: ElementRef, container: string): boolean {
  if (from.kind === "state") return end.path === from.path && end.path !== container;
  return keyOf(end) === keyOf(from);
}

/** Nearest sibling on that side. */
function beside(layout: Layout, path: string, direction: "next" | "previous"): ElementRef | null {
  const [parent, box] = [parentOf(path), layout.box(path)];
  if (parent === null || !box) return null;
  const from = centre(box);
  const sign = direction === "next" ? 1 : -1;
  let best: string | null = null;
  let least = Number.POSITIVE_INFINITY;
  for (const other of layout.children(parent)) {
    const there = layout.box(other);
    if (!there || other === path) continue;
    const at = centre(there);
    const ahead = (at.x - from.x) * sign;
    const away = ahead + 2 * Math.abs(at.y - from.y);
    if (ahead > 0 && away < least) [best, least] = [other, away];
  }
  return best === null ? null : { kind: "state", path: best };
}

/** Next port of a state, or the state itself before its first port; null after its last one. */
export function portWalk(layout: Layout, from: ElementRef, by: 1 | -1): ElementRef | null {
  if (isConnection(from)) return null;
  const ring: readonly ElementRef[] = [
    { kind: "state", path: from.path },
    ...layout.ports(from.path).flatMap(({ key }) => elementOf(key) ?? []),
  ];
  const index = ring.findIndex((element) => keyOf(element) === keyOf(from));
  return index < 0 ? null : (ring[index + by] ?? null);
}
