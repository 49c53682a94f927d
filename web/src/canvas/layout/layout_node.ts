/** Tree of the states of a machine as nested boxes, each in the coordinates of its container. `Layout` and `scene` walk it. A
 * tree is immutable. After a change of the machine, or during a gesture, a new tree shares all unchanged nodes with the old one. */

import { childBoxesOf } from "../../model/default_places.ts";
import { stateKey } from "../../model/element.ts";
import type { StateDocument } from "../../model/generated/protocol.ts";
import type { Box, Point, Size } from "../../model/geometry.ts";
import {
  defaultChildBox,
  nameBox,
  type PortPlace,
  portPlaces,
  readLayout,
  rootSize,
} from "../../model/layout_reader.ts";
import type { Machine } from "../../model/machine.ts";
import { EdgeRouting } from "../routing/edge_routing.ts";
import { Grid, same, touches } from "./grid.ts";
import type { RoutedLine } from "./lines.ts";

/** Input of a tree. Nodes read it late, because their content is computed on demand. */
export interface LayoutSource {
  readonly machine: Machine;
  /** Library states whose content is shown or hidden contrary to the file. */
  contents: ReadonlyMap<string, boolean>;
  /** States whose content is scaled with their boxes, though the machine does not contain that. */
  readonly scaled?: ReadonlySet<string>;
}

/** Margin around the content of a library, as a share of the shorter side of its state. */
const CONTENT_MARGIN = 0.04;

/** A state with its box. Its content is computed on demand. */
export class LayoutNode {
  readonly path: string;
  readonly key: string;
  readonly state: StateDocument;
  /** Box in the coordinates of the container. */
  readonly box: Box;
  /** Units of the container per unit inside. It is 1 except for the content of a library. */
  readonly scale: number;
  /** True if this is a library state with visible content. */
  readonly opened: boolean;
  readonly #source: LayoutSource;
  #children: readonly LayoutNode[] | null = null;
  /** Default boxes of all children, computed if the file does not place one of them. */
  #defaultBoxes: readonly Box[] | null = null;
  #ports: readonly PortPlace[] | null = null;
  #name: Box | null = null;
  #routing: EdgeRouting | null = null;
  #lines: readonly RoutedLine[] | null = null;
  #joined: ReadonlySet<string> | null = null;
  #childGrid: Grid | null = null;
  #gridBefore: Grid | null = null;
  #lineGrid: Grid | null = null;
  #indices: ReadonlyMap<string, number> | null = null;
  /** Previous node, kept until the lines are found: as input of the routing, and to show its lines until then. */
  #before: LayoutNode | null = null;
  /** Node before it was scaled, with all its content. */
  #stretched: { readonly from: LayoutNode; readonly by: Point } | null = null;

  constructor(source: LayoutSource, path: string, state: StateDocument, box: Box, scale: number) {
    this.#source = source;
    this.path = path;
    this.key = stateKey(path);
    this.state = state;
    this.box = box;
    this.scale = scale;
    this.opened = state.kind === "library" && opens(source, path, state);
  }

  /** Size in its own coordinates. */
  get size(): Size {
    return { width: this.box.width / this.scale, height: this.box.height / this.scale };
  }

  get children(): readonly LayoutNode[] {
    this.#children ??= this.#findChildren();
    return this.#children;
  }

  #findChildren(): readonly LayoutNode[] {
    if (this.#stretched) {
      const { from, by } = this.#stretched;
      return from.children.map((child) => child.stretched(boxTimes(child.box, by), by));
    }
    return childPaths(this.#source, this).flatMap((path, index) => {
      const state = this.#source.machine.state(path);
      return state ? [fresh(this.#source, this, path, state, index)] : [];
    });
  }

  /** Ports in its own coordinates. The members below use these coordinates, too. */
  get ports(): readonly PortPlace[] {
    this.#ports ??= this.#stretched
      ? stretchedPorts(this.#stretched.from.ports, this.#stretched.by)
      : portPlaces(this.state, this.path, this.size);
    return this.#ports;
  }

  get name(): Box {
    this.#name ??= this.#stretched
      ? boxTimes(this.#stretched.from.name, this.#stretched.by)
      : nameBox(this.state, this.size);
    return this.#name;
  }

  get lines(): readonly RoutedLine[] {
    this.wire(ALWAYS);
    return this.#lines ?? [];
  }

  /** True if all lines are known. Finding them is the most expensive part. */
  get hasLines(): boolean {
    return this.#lines !== null;
  }

  /** Continues to find lines while `mayGoOn` allows it; returns true when all are known. */
  wire(mayGoOn: () => boolean): boolean {
    if (this.#lines) return true;
    if (this.#stretched) {
      const { from, by } = this.#stretched;
      if (!from.wire(mayGoOn)) return false;
      this.#lines = stretchedLines(from.lines, by);
      return true;
    }
    const before = this.#before;
    if (before && !before.wire(mayGoOn)) return false;
    this.#routing ??= new EdgeRouting(this, before);
    if (!this.#routing.goOn(mayGoOn)) return false;
    this.#take(this.#routing, before);
    return true;
  }

  #take({ known, hasSameEnds }: EdgeRouting, before: LayoutNode | null): void {
    this.#lines = known;
    const gridBefore = before ? before.#lineGrid : null;
    this.#lineGrid = new Grid(boxesOf(known), gridBefore);
    if (hasSameEnds) this.#joined = before?.joined ?? null;
    this.#routing = null;
    this.#before = null;
  }

  /** Node whose lines are shown: this one, or the previous one until its own routing starts. */
  get #shown(): LayoutNode {
    const isOpen = this.#lines || this.#routing;
    return isOpen || !this.#before ? this : this.#before.#shown;
  }

  /** Ports that a transition inside starts from or leads to, as far as lines are known. */
  get joined(): ReadonlySet<string> {
    if (!this.#lines) return this.#before?.joined ?? NOTHING_JOINED;
    this.#joined ??= new Set(
      this.#lines.flatMap(({ kind, from, to }) => (kind === "transition" ? [from, to] : [])),
    );
    return this.#joined;
  }

  /** Spatial index of the children. */
  get childGrid(): Grid {
    this.#childGrid ??= new Grid(boxesOf(this.children), this.#gridBefore);
    this.#gridBefore = null;
    return this.#childGrid;
  }

  /** Calls back with the children that touch the area, which is in its own coordinates. */
  eachChild(area: Box, tell: (child: LayoutNode) => void): void {
    this.childGrid.each(area, (index) => {
      const child = this.children[index];
      if (child) tell(child);
    });
  }

  /** Calls back with the known lines whose bounds touch the area. */
  eachLine(area: Box, tell: (line: RoutedLine) => void): void {
    const { lines, grid } = this.#shown.#linesNow();
    if (!grid) {
      for (const line of lines) if (touches(line.box, area)) tell(line);
      return;
    }
    grid.each(area, (index) => {
      const line = lines[index];
      if (line) tell(line);
    });
  }

  #linesNow(): { readonly lines: readonly RoutedLine[]; readonly grid: Grid | null } {
    const lines = this.#lines;
    if (!lines) return { lines: this.#routing?.known ?? [], grid: null };
    this.#lineGrid ??= new Grid(boxesOf(lines));
    return { lines, grid: this.#lineGrid };
  }

  /** Box of a child. A child without a position in the file is placed beside the others. */
  childBox(state: StateDocument, index: number): Box {
    const { position, size } = readLayout(state);
    if (position && size) return { ...position, ...size };
    this.#defaultBoxes ??= childBoxesOf(
      childPaths(this.#source, this).map((path) => this.#source.machine.state(path)),
      this.size,
    );
    return this.#defaultBoxes[index] ?? defaultChildBox(index, this.size);
  }

  child(path: string): LayoutNode | undefined {
    return this.children[this.indexOf(path)];
  }

  /** Index of a child; -1 if the path is not a child. */
  indexOf(path: string): number {
    this.#indices ??= new Map(this.children.map((child, index) => [child.path, index]));
    return this.#indices.get(path) ?? -1;
  }

  /** Uses the lines of `before` as far as they are unchanged. */
  after(before: LayoutNode): this {
    this.#before = before.#routing || before.#lines || before.#stretched ? before : before.#before;
    this.#gridBefore = before.#childGrid;
    if (sameOrder(this.#children, before.#children)) this.#indices = before.#indices;
    return this;
  }

  /** Copy of the node in another box, with all its content scaled. */
  stretched(box: Box, by: Point): LayoutNode {
    const made = new LayoutNode(this.#source, this.path, this.state, box, this.scale);
    made.#stretched = { from: this, by };
    return made;
  }

  /** Node after a change of the machine or of the visible libraries; itself if nothing changed. `touched` are the paths of all
   * states with a change inside, if known. */
  renewed(next: Next, touched: ChangedPaths): LayoutNode {
    const { source, state, box, scale } = next;
    const stands = scale === this.scale && same(box, this.box);
    if (stands && touched && !touched.has(this.path)) return this;
    if (source.scaled?.has(this.path)) return this.stretched(box, shareOf(box, this.box));
    const inner = state.kind === "library" ? null : touched;
    const opened = state.kind === "library" && opens(source, this.path, state);
    const stays = stands && state === this.state && opened === this.opened;
    const made = new LayoutNode(source, this.path, state, box, scale);
    const children = this.#children && made.#renewedChildren(this, this.#children, inner);
    if (stays && children === this.#children) return this;
    made.#children = children;
    if (stays) {
      made.#ports = this.#ports;
      made.#name = this.#name;
    }
    return made.after(this);
  }

  #renewedChildren(
    was: LayoutNode,
    before: readonly LayoutNode[],
    touched: ChangedPaths,
  ): readonly LayoutNode[] {
    const paths = childPaths(this.#source, this);
    const sameSize = this.box.width === was.box.width && this.box.height === was.box.height;
    const mayStay =
      touched !== null && sameSize && this.scale === was.scale && was.#defaultBoxes === null;
    const after: LayoutNode[] = [];
    let changed = paths.length !== before.length;
    paths.forEach((path, index) => {
      const there = before[index];
      const known = there?.path === path ? there : was.child(path);
      const stays = known === there && mayStay && !touched.has(path);
      const child = stays ? there : this.#childAt(path, index, known, touched);
      if (!child) return;
      after.push(child);
      changed ||= child !== there;
    });
    return changed ? after : before;
  }

  #childAt(
    path: string,
    index: number,
    known: LayoutNode | undefined,
    touched: ChangedPaths,
  ): LayoutNode | undefined {
    const state = this.#source.machine.state(path);
    if (!state) return undefined;
    const next = { source: this.#source, state, ...placeIn(this, state, index) };
    return known
      ? known.renewed(next, touched)
      : new LayoutNode(this.#source, path, state, next.box, next.scale);
  }
}

/** Paths of states with a change inside; null means that any state may have changed. */
export type ChangedPaths = ReadonlySet<string> | null;

interface Next {
  readonly source: LayoutSource;
  readonly state: StateDocument;
  readonly box: Box;
  readonly scale: number;
}

const ALWAYS = () => true;
const NOTHING_JOINED: ReadonlySet<string> = new Set();

/** Tree of a machine; null if the machine is empty. `before` is its previous tree, `touched` are the changes since then. */
export function treeOf(
  source: LayoutSource,
  before: LayoutNode | null,
  touched: ChangedPaths,
): LayoutNode | null {
  const state = source.machine.state(source.machine.root);
  if (!state) return null;
  const box = { x: 0, y: 0, ...rootSize(state) };
  if (before?.path === source.machine.root) {
    return before.renewed({ source, state, box, scale: 1 }, touched);
  }
  return new LayoutNode(source, source.machine.root, state, box, 1);
}

function opens(source: LayoutSource, path: string, state: StateDocument): boolean {
  return source.contents.get(path) ?? readLayout(state).showsContent;
}

const NONE: readonly string[] = [];

function childPaths(source: LayoutSource, of: LayoutNode): readonly string[] {
  if (of.state.kind === "library" && !of.opened) return NONE;
  return source.machine.children(of.path);
}

function fresh(
  source: LayoutSource,
  container: LayoutNode,
  path: string,
  state: StateDocument,
  index: number,
): LayoutNode {
  const { box, scale } = placeIn(container, state, index);
  return new LayoutNode(source, path, state, box, scale);
}

/** Box of a child, and units of the container per unit inside the child. */
function placeIn(
  container: LayoutNode,
  state: StateDocument,
  index: number,
): { readonly box: Box; readonly scale: number } {
  if (container.state.kind !== "library") {
    return { box: container.childBox(state, index), scale: 1 };
  }
  return fitted(rootSize(state), container.size);
}

/** Largest centred box for the content of a library, and its scale. */
function fitted(content: Size, size: Size): { readonly box: Box; readonly scale: number } {
  const margin = Math.min(size.width, size.height) * CONTENT_MARGIN;
  const [free, high] = [size.width - 2 * margin, size.height - 2 * margin];
  const scale = Math.min(
    free / Math.max(content.width, 1e-9),
    high / Math.max(content.height, 1e-9),
  );
  const [width, height] = [content.width * scale, content.height * scale];
  const at: Point = { x: (size.width - width) / 2, y: (size.height - height) / 2 };
  return { box: { ...at, width, height }, scale };
}

function shareOf(box: Box, of: Box): Point {
  return { x: box.width / (of.width || 1), y: box.height / (of.height || 1) };
}

function boxTimes(box: Box, by: Point): Box {
  return { ...times(box, by), width: box.width * by.x, height: box.height * by.y };
}

function times({ x, y }: Point, by: Point): Point {
  return { x: x * by.x, y: y * by.y };
}

/** Ports that keep their relative position on the border. */
function stretchedPorts(ports: readonly PortPlace[], by: Point): readonly PortPlace[] {
  return ports.map((port) => ({ ...port, at: times(port.at, by) }));
}

function stretchedLines(lines: readonly RoutedLine[], by: Point): readonly RoutedLine[] {
  return lines.map((line) => {
    const points = line.points.map((point) => times(point, by));
    return { ...line, points, box: boxTimes(line.box, by) };
  });
}

/** True if both lists have equal paths in equal order. */
function sameOrder(
  children: readonly LayoutNode[] | null,
  before: readonly LayoutNode[] | null,
): boolean {
  return (
    children !== null &&
    before?.length === children.length &&
    children.every((child, index) => child === before[index] || child.path === before[index]?.path)
  );
}

function boxesOf(parts: readonly { readonly box: Box }[]): readonly Box[] {
  return parts.map(({ box }) => box);
}
