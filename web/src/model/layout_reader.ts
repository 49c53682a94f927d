/** Positions of a state and its parts, from the layout in the file, with the defaults of the reference. Sizes are those of the
 * file: a state uses the coordinates of its container, its parts use its own; y points down. */

import { type ElementKey, keyOf } from "./element.ts";
import type { JsonValue, LayoutDocument, StateDocument } from "./generated/protocol.ts";
import type { Box, Point, Size } from "./geometry.ts";
import { ABORTED, outcomesOf, PREEMPTED, portsOf } from "./machine.ts";
import { perOwner } from "./per_owner.ts";

/** Layout of one state and its parts; undefined where the file has no value. */
interface StateLayout {
  readonly position: Point | undefined;
  readonly size: Size | undefined;
  readonly nameBox: Box | undefined;
  /** Colour in CSS notation. */
  readonly background: string | undefined;
  readonly showsContent: boolean;
  /** Points of parts by their prefix and id in the file: `outcome-1`, `input_data_port0`, `income`. */
  readonly ports: ReadonlyMap<string, Point>;
  /** Waypoints by connection: `transition3`, `data_flow0`. */
  readonly waypoints: ReadonlyMap<string, readonly Point[]>;
}

type Json = JsonValue | undefined;

function field(value: Json, key: string): Json {
  if (value === null || typeof value !== "object" || Array.isArray(value)) return undefined;
  return value[key];
}

/** Items of a list, or of a tuple in the notation of the reference. */
function items(value: Json): readonly JsonValue[] {
  if (Array.isArray(value)) return value;
  const inner = field(value, "items");
  return Array.isArray(inner) ? inner : [];
}

function pair(value: Json): readonly [number, number] | undefined {
  const [first, second] = items(value);
  return typeof first === "number" && typeof second === "number" ? [first, second] : undefined;
}

function point(value: Json): Point | undefined {
  const found = pair(value);
  return found && { x: found[0], y: found[1] };
}

function size(value: Json): Size | undefined {
  const found = pair(value);
  return found && { width: found[0], height: found[1] };
}

function colour(value: Json): string | undefined {
  const parts = items(value);
  const [red, green, blue] = parts;
  if (typeof red !== "number" || typeof green !== "number" || typeof blue !== "number") {
    return undefined;
  }
  const byte = (part: number) => Math.round(Math.min(1, Math.max(0, part)) * 255);
  return `rgb(${byte(red)} ${byte(green)} ${byte(blue)})`;
}

/** The part of an entry that belongs to the reference's canvas. Older files use other names and an upward y axis. */
function drawn(entry: Json): { readonly entry: Json; readonly upwards: boolean } {
  const gui = field(entry, "gui");
  const now = field(gui, "editor_gaphas");
  if (now !== undefined) return { entry: now, upwards: false };
  return { entry: field(gui, "editor_opengl") ?? field(gui, "editor"), upwards: true };
}

function placed(entry: Json): Point | undefined {
  const { entry: found, upwards } = drawn(entry);
  const at = point(field(found, "rel_pos")) ?? point(field(found, "inner_rel_pos"));
  return at && upwards ? { x: at.x, y: -at.y } : at;
}

function waypoints(entry: Json): readonly Point[] {
  const { entry: found, upwards } = drawn(entry);
  const points = items(field(found, "waypoints")).flatMap((each) => point(each) ?? []);
  return upwards ? points.map(({ x, y }) => ({ x, y: -y })) : points;
}

const LINE = /^(transition|data_flow)-?\d+$/;

function read(layout: LayoutDocument): StateLayout {
  const json = layout as unknown as JsonValue;
  const { entry } = drawn(json);
  const ports = new Map<string, Point>();
  const lines = new Map<string, readonly Point[]>();
  for (const key of Object.keys(layout)) {
    if (key === "gui") continue;
    if (LINE.test(key)) lines.set(key, waypoints(field(json, key)));
    const at = placed(field(json, key));
    if (at) ports.set(key, at);
  }
  const name = field(entry, "name");
  const [nameAt, nameSize] = [point(field(name, "rel_pos")), size(field(name, "size"))];
  return {
    position: placed(json),
    size: size(field(entry, "size")),
    nameBox: nameAt && nameSize && { ...nameAt, ...nameSize },
    background: colour(field(entry, "background_color")),
    showsContent: field(field(json, "gui"), "show_content") === true,
    ports,
    waypoints: lines,
  };
}

const NOTHING: StateLayout = read({});
const readOnce = perOwner(read);

/** Layout of a state in the file. Each layout is parsed once. */
export function readLayout(state: StateDocument): StateLayout {
  return state.layout ? readOnce(state.layout) : NOTHING;
}

/** Prefixes of ids of parts in the file. */
const IN_FILE = {
  outcome: "outcome",
  input: "input_data_port",
  output: "output_data_port",
  scoped_variable: "scoped_variable",
} as const;

/** A port on the border of a state: the start or end of connections. */
export interface PortPlace {
  readonly key: ElementKey;
  readonly kind: "income" | keyof typeof IN_FILE;
  /** 0 for the income. */
  readonly id: number;
  readonly name: string;
  /** In the state's own coordinates, on its border. */
  readonly at: Point;
}

/** Positions of the ports of a state of this size. Their keys contain `path`. */
export function portPlaces(state: StateDocument, path: string, box: Size): readonly PortPlace[] {
  const { ports } = readLayout(state);
  const step = Math.min(box.width, box.height);
  const found: PortPlace[] = [];
  const put = (kind: PortPlace["kind"], id: number, name: string, otherwise: Point) => {
    const inFile = kind === "income" ? "income" : `${IN_FILE[kind]}${id}`;
    const element = kind === "income" ? ({ kind, path } as const) : ({ kind, path, id } as const);
    const at = onBorder(ports.get(inFile) ?? otherwise, box);
    found.push({ key: keyOf(element), kind, id, name, at });
  };
  put("income", 0, "income", { x: 0, y: step * 0.1 });
  let row = 0;
  for (const { id, name } of outcomesOf(state)) {
    if (id === ABORTED) put("outcome", id, name, { x: box.width - step * 0.1, y: 0 });
    else if (id === PREEMPTED) put("outcome", id, name, { x: box.width - step * 0.25, y: 0 });
    else put("outcome", id, name, spread(row++, step, box, "right"));
  }
  const lists = [
    ["input", "left"],
    ["output", "right"],
    ["scoped_variable", "bottom"],
  ] as const;
  for (const [kind, side] of lists) {
    portsOf(state, kind).forEach(({ id, name }, index) => {
      const at =
        side === "bottom" ? alongBottom(index, step, box) : fromBottom(index, step, box, side);
      put(kind, id, name, at);
    });
  }
  return found;
}

function spread(row: number, step: number, box: Size, side: "left" | "right"): Point {
  return { x: side === "left" ? 0 : box.width, y: wrapped(step * (0.1 + 0.12 * row), box.height) };
}

function fromBottom(row: number, step: number, box: Size, side: "left" | "right"): Point {
  const y = box.height - wrapped(step * (0.1 + 0.12 * row), box.height);
  return { x: side === "left" ? 0 : box.width, y };
}

function alongBottom(column: number, step: number, box: Size): Point {
  return { x: wrapped(step * (0.15 + 0.2 * column), box.width), y: box.height };
}

/** Wraps around with a small offset if there are too many. */
function wrapped(at: number, length: number): number {
  return at <= length * 0.95 ? at : (at % (length * 0.85)) + length * 0.05;
}

/** Nearest point on the border. */
export function onBorder(at: Point, box: Size): Point {
  const x = Math.min(box.width, Math.max(0, at.x));
  const y = Math.min(box.height, Math.max(0, at.y));
  const inset = Math.min(x, y, box.width - x, box.height - y);
  if (inset <= 0) return { x, y };
  if (inset === x) return { x: 0, y };
  if (inset === box.width - x) return { x: box.width, y };
  return inset === y ? { x, y: 0 } : { x, y: box.height };
}

const ROOT_SIZE: Size = { width: 100, height: 100 };

/** Box of a state without a layout in a container of this size; `index` is its place among its siblings. */
export function defaultChildBox(index: number, container: Size): Box {
  const side = Math.min(container.width, container.height) * 0.2;
  const pitch = side * 1.2;
  const columns = Math.max(1, Math.floor((container.width - side * 0.4) / pitch));
  const rows = Math.max(1, Math.floor((container.height - side * 0.8) / pitch));
  const lap = Math.floor(index / (columns * rows));
  const place = index % (columns * rows);
  const shift = lap * side * 0.1;
  return {
    x: side * 0.2 + (place % columns) * pitch + shift,
    y: side * 0.6 + Math.floor(place / columns) * pitch + shift,
    width: side,
    height: side,
  };
}

/** Box of a state in the coordinates of its container; `index` is its place among its siblings. */
export function childBox(child: StateDocument, index: number, container: Size): Box {
  const { position, size: known } = readLayout(child);
  const otherwise = defaultChildBox(index, container);
  return {
    ...(position ?? { x: otherwise.x, y: otherwise.y }),
    ...(known ?? { width: otherwise.width, height: otherwise.height }),
  };
}

/** Size of the root state; a default without a layout. */
export function rootSize(root: StateDocument): Size {
  return readLayout(root).size ?? ROOT_SIZE;
}

/** Box of the name, in the state's own coordinates. */
export function nameBox(state: StateDocument, box: Size): Box {
  const inset = Math.min(box.width, box.height) / 25;
  return (
    readLayout(state).nameBox ?? {
      x: inset,
      y: inset,
      width: Math.max(0, box.width - 2 * inset),
      height: Math.max(0, box.height * 0.4 - inset),
    }
  );
}

/** Waypoints of a connection, in the coordinates of its container. */
export function waypointsOf(
  container: StateDocument,
  kind: "transition" | "data_flow",
  id: number,
): readonly Point[] {
  return readLayout(container).waypoints.get(`${kind}${id}`) ?? [];
}
