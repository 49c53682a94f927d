/** `Layout` of the current machine, based on a tree that is cached between changes. */

import type { Box, Point } from "../../model/geometry.ts";
import type { PortPlace } from "../../model/layout_reader.ts";
import type { Machine } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { provisional } from "../../store/document/provisional.ts";
import type { ViewModes } from "../../store/page/view.ts";
import type { ProvisionalEdit } from "../overlay.ts";
import type { Layout, Route } from "./layout.ts";
import { type ChangedPaths, type LayoutNode, type LayoutSource, treeOf } from "./layout_node.ts";

/** Settings of a view that affect positions. */
interface LayoutView {
  readonly modes: ViewModes;
  readonly contents: ReadonlyMap<string, boolean>;
}

/** A state, and the position of its coordinates in those of the root. */
export interface NodeFrame {
  readonly at: LayoutNode;
  readonly x: number;
  readonly y: number;
  /** Units of the root per unit inside. */
  readonly unit: number;
}

/** A layout with the tree that it is computed from. */
export interface LayoutTree extends Layout {
  readonly root: LayoutNode | null;
  readonly frame: (path: string) => NodeFrame | undefined;
}

interface KeptLayout {
  readonly version: number;
  readonly contents: ReadonlyMap<string, boolean>;
  readonly source: LayoutSource;
  readonly tree: LayoutNode | null;
  readonly layout: LayoutTree;
  /** Layout with the edit that was previewed last. */
  shown: { readonly edit: ProvisionalEdit; readonly layout: LayoutTree } | null;
}

const KEPT = new WeakMap<Machine, KeptLayout>();

/** Layout of the machine as it is, or as it would be after an edit. Returns the cached object while nothing changes. */
export function layoutTreeOf(
  machine: Machine,
  view: LayoutView,
  edit: ProvisionalEdit | null = null,
): LayoutTree {
  const kept = keptLayout(machine, view);
  if (!edit) return kept.layout;
  if (kept.shown?.edit !== edit) kept.shown = { edit, layout: over(treeAfter(kept, edit)) };
  return kept.shown.layout;
}

function keptLayout(machine: Machine, { contents }: LayoutView): KeptLayout {
  const kept = KEPT.get(machine);
  if (kept && kept.version === machine.version && kept.contents === contents) return kept;
  const source: LayoutSource = kept?.source ?? { machine, contents };
  source.contents = contents;
  const touched = kept?.contents === contents ? touchedSince(machine, kept.version) : null;
  const tree = treeOf(source, kept?.tree ?? null, touched);
  const { version } = machine;
  const made = { source, version, contents, tree, layout: over(tree), shown: null };
  KEPT.set(machine, made);
  return made;
}

/** Tree after the edit; the current tree if the result of the edit is unknown. It shares all nodes that the edit does not touch. */
function treeAfter(
  { source, tree, contents }: KeptLayout,
  { edit, held, isScaled }: ProvisionalEdit,
): LayoutNode | null {
  const then = provisional(source.machine, edit);
  if (!then) return tree;
  const touched = withOuter(then.touched);
  const scaled = isScaled ? held : undefined;
  return treeOf({ machine: then.machine, contents, ...(scaled && { scaled }) }, tree, touched);
}

/** Paths of the states that changed since a version, and of all states around them; null means that any state may have changed. */
function touchedSince(machine: Machine, version: number): ChangedPaths {
  const touched = machine.touchedSince?.(version);
  return touched ? withOuter(touched) : null;
}

/** The paths, and those of all states around them. */
function withOuter(paths: Iterable<string>): ReadonlySet<string> {
  const all = new Set<string>();
  for (const each of paths) {
    for (let path: string | null = each; path !== null && !all.has(path); path = parentOf(path)) {
      all.add(path);
    }
  }
  return all;
}

const NONE: readonly never[] = [];

function over(root: LayoutNode | null): LayoutTree {
  const frames = new Map<string, NodeFrame>();
  if (root) frames.set(root.path, { at: root, x: 0, y: 0, unit: 1 });
  const frame = (path: string): NodeFrame | undefined => {
    const known = frames.get(path);
    if (known) return known;
    const end = path.lastIndexOf("/");
    const outer = end < 0 ? undefined : frame(path.slice(0, end));
    const child = outer?.at.child(path);
    if (!outer || !child) return undefined;
    const found = inside(outer, child);
    frames.set(path, found);
    return found;
  };
  return {
    root,
    frame,
    box: (path) => {
      const found = frame(path);
      return found && outline(found);
    },
    unit: (path) => frame(path)?.unit ?? 1,
    children: (path) => frame(path)?.at.children.map((child) => child.path) ?? NONE,
    ports: remembered(frame, portsAt),
    name: (path) => {
      const found = frame(path);
      return found && boxAt(found, found.at.name);
    },
    routes: remembered(frame, routesAt),
  };
}

export function inside(outer: NodeFrame, child: LayoutNode): NodeFrame {
  const { x, y } = pointAt(outer, child.box);
  return { at: child, x, y, unit: outer.unit * child.scale };
}

function outline({ at, x, y, unit }: NodeFrame): Box {
  const { width, height } = at.size;
  return { x, y, width: width * unit, height: height * unit };
}

/** Converts a point of a state to the root's coordinates. */
export function pointAt(frame: NodeFrame, { x, y }: Point): Point {
  return { x: frame.x + x * frame.unit, y: frame.y + y * frame.unit };
}

function boxAt(frame: NodeFrame, box: Box): Box {
  const { width, height } = box;
  return { ...pointAt(frame, box), width: width * frame.unit, height: height * frame.unit };
}

function remembered<T>(
  frame: (path: string) => NodeFrame | undefined,
  find: (frame: NodeFrame) => readonly T[],
): (path: string) => readonly T[] {
  const known = new Map<string, readonly T[]>();
  return (path) => {
    let found = known.get(path);
    if (!found) {
      const at = frame(path);
      found = at ? find(at) : NONE;
      known.set(path, found);
    }
    return found;
  };
}

function portsAt(frame: NodeFrame): readonly PortPlace[] {
  return frame.at.ports.map((port) => ({ ...port, at: pointAt(frame, port.at) }));
}

function routesAt(frame: NodeFrame): readonly Route[] {
  return frame.at.lines.map(({ kind, id, points, waypoints }) => ({
    kind,
    path: frame.at.path,
    id,
    points: points.map((point) => pointAt(frame, point)),
    waypoints,
  }));
}
