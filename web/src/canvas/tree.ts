/** The states of a machine as boxes inside boxes, each in the coordinates of its container: what `Places` and `scene` walk.
 * A tree is never changed. A machine that changed, or a gesture over it, gets a tree that shares all that stayed the same. */

import {
  childBox,
  layoutOf,
  nameBox,
  type PortPlace,
  portPlaces,
  rootSize,
} from "../model/drawing.ts";
import { stateKey } from "../model/element.ts";
import type { StateDocument } from "../model/generated/protocol.ts";
import type { Box, Point, Size } from "../model/geometry.ts";
import type { Machine } from "../model/machine.ts";
import { Grid } from "./grid.ts";
import { type Line, linesOf } from "./lines.ts";

/** What a tree is made from: as it is now, since what lies inside states is found late. */
export interface Ground {
  readonly machine: Machine;
  /** Library states whose content is shown or hidden other than the file says. */
  contents: ReadonlyMap<string, boolean>;
}

/** How much of the shorter side of a library state stays free around its content. */
const CONTENT_MARGIN = 0.04;

/** A state in its place. What lies inside it is found when it is asked for. */
export class PlacedState {
  readonly path: string;
  readonly key: string;
  readonly state: StateDocument;
  /** In the coordinates of the container. */
  readonly box: Box;
  /** So many units of the container is one inside: 1 but for the content of a library. */
  readonly scale: number;
  /** Whether it is a library state whose content is to be seen. */
  readonly opened: boolean;
  readonly #ground: Ground;
  #children: readonly PlacedState[] | null = null;
  #ports: readonly PortPlace[] | null = null;
  #name: Box | null = null;
  #lines: readonly Line[] | null = null;
  #joined: ReadonlySet<string> | null = null;
  #childGrid: Grid | null = null;
  #lineGrid: Grid | null = null;
  #byPath: ReadonlyMap<string, PlacedState> | null = null;
  /** What it was before it was stretched, with all that lies inside it. */
  #stretched: { readonly from: PlacedState; readonly by: Point } | null = null;

  constructor(ground: Ground, path: string, state: StateDocument, box: Box, scale: number) {
    this.#ground = ground;
    this.path = path;
    this.key = stateKey(path);
    this.state = state;
    this.box = box;
    this.scale = scale;
    this.opened = state.kind === "library" && opens(ground, path, state);
  }

  /** Its size in its own coordinates. */
  get size(): Size {
    return { width: this.box.width / this.scale, height: this.box.height / this.scale };
  }

  get children(): readonly PlacedState[] {
    this.#children ??= this.#findChildren();
    return this.#children;
  }

  #findChildren(): readonly PlacedState[] {
    if (this.#stretched) {
      const { from, by } = this.#stretched;
      return from.children.map((child) => child.stretched(boxTimes(child.box, by), by));
    }
    return childPaths(this.#ground, this).flatMap((path, index) => {
      const state = this.#ground.machine.state(path);
      return state ? [fresh(this.#ground, this, path, state, index)] : [];
    });
  }

  /** In its own coordinates, as all that follows. */
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

  get lines(): readonly Line[] {
    this.#lines ??= this.#stretched
      ? stretchedLines(this.#stretched.from.lines, this.#stretched.by)
      : linesOf(this, new Map());
    return this.#lines;
  }

  /** Ports that a transition inside leaves or leads to. */
  get joined(): ReadonlySet<string> {
    this.#joined ??= new Set(
      this.lines.flatMap(({ kind, from, to }) => (kind === "transition" ? [from, to] : [])),
    );
    return this.#joined;
  }

  /** Whether the lines are known: finding them is the dearest part. */
  get hasLines(): boolean {
    return this.#lines !== null;
  }

  /** Tells the children that the area, in its own coordinates, touches. */
  eachChild(area: Box, tell: (child: PlacedState) => void): void {
    this.#childGrid ??= new Grid(this.children.map((child) => child.box));
    this.#childGrid.each(area, (index) => {
      const child = this.children[index];
      if (child) tell(child);
    });
  }

  /** Tells the lines whose surroundings the area touches. */
  eachLine(area: Box, tell: (line: Line) => void): void {
    this.#lineGrid ??= new Grid(this.lines.map((line) => line.box));
    this.#lineGrid.each(area, (index) => {
      const line = this.lines[index];
      if (line) tell(line);
    });
  }

  child(path: string): PlacedState | undefined {
    this.#byPath ??= new Map(this.children.map((child) => [child.path, child]));
    return this.#byPath.get(path);
  }

  /** The same in another box, or with other parts; what is left out is found anew. */
  with(parts: Parts): PlacedState {
    const { path, state, box, scale } = this;
    const ground = parts.ground ?? this.#ground;
    const made = new PlacedState(ground, path, parts.state ?? state, parts.box ?? box, scale);
    made.#children = parts.children ?? null;
    made.#ports = parts.ports ?? null;
    made.#name = parts.name ?? null;
    made.#lines = parts.lines ?? null;
    return made;
  }

  /** The same in another box with all inside it larger or smaller along. */
  stretched(box: Box, by: Point): PlacedState {
    const made = new PlacedState(this.#ground, this.path, this.state, box, this.scale);
    made.#stretched = { from: this, by };
    return made;
  }

  /** The same after the machine or what is shown of its libraries changed; itself if all stayed. */
  renewed(ground: Ground, state: StateDocument, box: Box, scale: number): PlacedState {
    if (scale === this.scale && same(box, this.box) && this.#isTrue(state)) return this;
    const children = this.#children && this.#renewedChildren(ground, state, box, scale);
    const sameBox = same(box, this.box) && scale === this.scale;
    const opened = state.kind === "library" && opens(ground, this.path, state);
    const stays = state === this.state && sameBox && opened === this.opened;
    if (stays && children === this.#children) return this;
    const made = new PlacedState(ground, this.path, state, box, scale);
    made.#children = children;
    if (state !== this.state || !sameBox) return made;
    made.#ports = this.#ports;
    made.#name = this.#name;
    if (children && sameOutlines(children, this.#children)) made.#lines = this.#lines;
    return made;
  }

  /** Whether nothing is different in the state and in all inside it that is known. */
  #isTrue(state: StateDocument): boolean {
    if (state !== this.state) return false;
    const { machine } = this.#ground;
    if (state.kind === "library" && opens(this.#ground, this.path, state) !== this.opened) {
      return false;
    }
    const children = this.#children;
    if (children === null) return true;
    const paths = childPaths(this.#ground, this);
    if (paths.length !== children.length) return false;
    return children.every((child, index) => {
      const now = machine.state(child.path);
      return child.path === paths[index] && now !== undefined && child.#isTrue(now);
    });
  }

  #renewedChildren(
    ground: Ground,
    state: StateDocument,
    box: Box,
    scale: number,
  ): readonly PlacedState[] {
    const before = this.#children ?? [];
    const here = new PlacedState(ground, this.path, state, box, scale);
    const paths = childPaths(ground, here);
    let changed = paths.length !== before.length;
    const after = paths.flatMap((path, index) => {
      const known = before[index]?.path === path ? before[index] : this.child(path);
      const now = ground.machine.state(path);
      if (!now) return [];
      const place = placeIn(here, now, index);
      const child = known
        ? known.renewed(ground, now, place.box, place.scale)
        : new PlacedState(ground, path, now, place.box, place.scale);
      changed ||= child !== before[index];
      return [child];
    });
    return changed ? after : before;
  }
}

interface Parts {
  readonly ground?: Ground;
  readonly state?: StateDocument;
  readonly box?: Box;
  readonly children?: readonly PlacedState[];
  readonly ports?: readonly PortPlace[];
  readonly name?: Box;
  readonly lines?: readonly Line[];
}

/** The tree of a machine; null if it is empty. `before` is its tree as it was. */
export function treeOf(ground: Ground, before: PlacedState | null): PlacedState | null {
  const state = ground.machine.state(ground.machine.root);
  if (!state) return null;
  const box = { x: 0, y: 0, ...rootSize(state) };
  if (before?.path === ground.machine.root) return before.renewed(ground, state, box, 1);
  return new PlacedState(ground, ground.machine.root, state, box, 1);
}

function opens(ground: Ground, path: string, state: StateDocument): boolean {
  return ground.contents.get(path) ?? layoutOf(state).showsContent;
}

const NONE: readonly string[] = [];

function childPaths(ground: Ground, of: PlacedState): readonly string[] {
  if (of.state.kind === "library" && !of.opened) return NONE;
  return ground.machine.children(of.path);
}

function fresh(
  ground: Ground,
  container: PlacedState,
  path: string,
  state: StateDocument,
  index: number,
): PlacedState {
  const { box, scale } = placeIn(container, state, index);
  return new PlacedState(ground, path, state, box, scale);
}

function placeIn(
  container: PlacedState,
  state: StateDocument,
  index: number,
): { readonly box: Box; readonly scale: number } {
  if (container.state.kind !== "library") {
    return { box: childBox(state, index, container.size), scale: 1 };
  }
  return fitted(rootSize(state), container.size);
}

/** The content of a library as large as fits into the library state. */
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

export function boxTimes(box: Box, by: Point): Box {
  return { ...times(box, by), width: box.width * by.x, height: box.height * by.y };
}

function times({ x, y }: Point, by: Point): Point {
  return { x: x * by.x, y: y * by.y };
}

/** Ports that keep their share of the border. */
export function stretchedPorts(ports: readonly PortPlace[], by: Point): readonly PortPlace[] {
  return ports.map((port) => ({ ...port, at: times(port.at, by) }));
}

function stretchedLines(lines: readonly Line[], by: Point): readonly Line[] {
  return lines.map((line) => {
    const points = line.points.map((point) => times(point, by));
    return { ...line, points, box: boxTimes(line.box, by) };
  });
}

export function same(one: Box, other: Box): boolean {
  return (
    one.x === other.x &&
    one.y === other.y &&
    one.width === other.width &&
    one.height === other.height
  );
}

/** Whether the same states stand in the same boxes with the same ports. */
function sameOutlines(
  children: readonly PlacedState[],
  before: readonly PlacedState[] | null,
): boolean {
  return (
    before?.length === children.length &&
    children.every((child, index) => {
      const was = before[index];
      return was?.path === child.path && was.state === child.state && same(was.box, child.box);
    })
  );
}
