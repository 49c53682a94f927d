/** Draws a connection from a port to another port, or to a state, which gets a suitable port. A key sets waypoints on the way;
 * for a connection that was started by keyboard, clicks set them, too. The keyboard cycles through the targets. */

import { type ElementKey, keyOf } from "../../model/element.ts";
import { nameOf } from "../../model/ends.ts";
import type { Edit } from "../../model/generated/protocol.ts";
import type { Point } from "../../model/geometry.ts";
import type { Machine } from "../../model/machine.ts";
import { idOf, isWithin, parentOf } from "../../model/path.ts";
import { connect, connectToState, ledElsewhere } from "../../plan/connect.ts";
import {
  isRefused,
  type Plan,
  type Planned,
  type Refused,
  refused,
  together,
} from "../../plan/plan.ts";
import { screenBox, screenFromWorld, visibleBox } from "../camera/camera.ts";
import { gripAt, statesAt } from "../hit/hit.ts";
import type { CanvasPort } from "../hit/look.ts";
import { NO_OVERLAY, type Overlay } from "../overlay.ts";
import { described } from "../reader/describe.ts";
import { editsOf } from "./edits.ts";
import {
  type Gesture,
  inState,
  ownState,
  type Pointer,
  type ToolContext,
  worldOf,
} from "./gesture.ts";
import {
  endsBetween,
  isData,
  isLegal,
  nearerTo,
  nearestPort,
  type PortPair,
  type VisiblePort,
  visiblePorts,
} from "./targets.ts";

/** Distance at which a line snaps to a port, in CSS pixels. */
const SNAP = 18;

interface ConnectState {
  readonly from: CanvasPort;
  readonly at: Point;
  readonly data: boolean;
  readonly isSticky: boolean;
  readonly through: readonly Point[];
  /** Visible ports and their possible connections, for one camera and version of the machine. */
  readonly visible: ConnectPorts;
}

interface ConnectPorts {
  readonly camera: ToolContext["camera"];
  readonly version: number;
  readonly ports: readonly VisiblePort[];
  readonly legal: ReadonlyMap<ElementKey, PortPair>;
}

/** Starts a connection at a port. With `isSticky` it continues without a pressed button. */
export function connecting(
  from: CanvasPort,
  pointer: Pointer | null,
  context: ToolContext,
  isSticky: boolean,
): Gesture {
  const place = context.layout.ports(from.path).find(({ key }) => key === keyOf(from));
  const box = visibleBox(context.camera, context.size);
  const at = place?.at ?? { x: box.x, y: box.y };
  const data = isData(from);
  const connectState = {
    from,
    at,
    data,
    isSticky,
    through: [],
    visible: look(from, data, context),
  };
  const start = pointer ?? { ...screenFromWorld(context.camera, at), ...NO_KEYS };
  return pointer === null
    ? chosen(connectState, 0, start, context)
    : next(connectState, start, context);
}

const NO_KEYS = { shift: false, ctrl: false, alt: false };

function look(from: CanvasPort, data: boolean, context: ToolContext): ConnectPorts {
  const ports = visiblePorts(context, data);
  const legal = new Map<ElementKey, PortPair>();
  for (const { element } of ports) {
    const ends = endsBetween(context.machine, from, element);
    if (isLegal(ends)) legal.set(keyOf(element), ends);
  }
  return { camera: context.camera, version: context.machine.version, ports, legal };
}

/** Updates the ports after a zoom or an edit by another user during the gesture. */
function current(connectState: ConnectState, context: ToolContext): ConnectState {
  const { visible, from, data } = connectState;
  const isSame = visible.camera === context.camera && visible.version === context.machine.version;
  return isSame ? connectState : { ...connectState, visible: look(from, data, context) };
}

interface ConnectAim {
  readonly to: Point;
  readonly legal: boolean | null;
  readonly target: ElementKey | null;
  readonly message: string | null;
  readonly plan: () => Planned | null;
}

function next(before: ConnectState, pointer: Pointer, context: ToolContext): Gesture {
  const connectState = current(before, context);
  return shown(connectState, aimAt(connectState, pointer, context), pointer, context, null);
}

function shown(
  connectState: ConnectState,
  aim: ConnectAim,
  pointer: Pointer,
  context: ToolContext,
  index: number | null,
): Gesture {
  return {
    name: "connect",
    cursor: aim.legal === false ? "not-allowed" : "crosshair",
    overlay: overlayOf(connectState, aim, pointer),
    isSticky: connectState.isSticky,
    move: (to, then) => next(connectState, to, then),
    result: () => {
      const plan = aim.plan();
      if (plan) return { plan: withWaypoints(plan, connectState, context) };
      return aim.legal === null && !connectState.isSticky ? { plan: toNothing(connectState) } : {};
    },
    mark: (then) => {
      if (aim.legal !== null) return null;
      const at = worldOf(pointer, then);
      return next({ ...connectState, through: [...connectState.through, at] }, pointer, then);
    },
    cycle: (by, then) => chosen(connectState, index === null ? 0 : index + by, pointer, then),
  };
}

function toNothing({ data }: ConnectState): Refused {
  const ends = data ? "a state or a port" : "a state or an outcome";
  return refused(`Nothing is connected: drop the line on ${ends}.`);
}

function overlayOf(
  { at, data, through, visible }: ConnectState,
  aim: ConnectAim,
  pointer: Point,
): Overlay {
  const targets = new Map<ElementKey, boolean>();
  for (const key of visible.legal.keys()) targets.set(key, true);
  if (aim.target !== null) targets.set(aim.target, aim.legal === true);
  const message =
    aim.message === null ? null : { at: pointer, text: aim.message, bad: aim.legal === false };
  return {
    ...NO_OVERLAY,
    line: { from: at, to: aim.to, through, data, legal: aim.legal },
    targets,
    message,
  };
}

/** Target at the pointer: a suitable port, an unsuitable port, a state, or none. */
function aimAt(connectState: ConnectState, pointer: Pointer, context: ToolContext): ConnectAim {
  const { visible, from } = connectState;
  const fitting = visible.ports.filter(({ element }) => visible.legal.has(keyOf(element)));
  const near = nearestPort(fitting, pointer, context, SNAP);
  if (near) return atPort(visible, near, context);
  const others = visible.ports.filter(({ element }) => keyOf(element) !== keyOf(from));
  const wrong = nearestPort(others, pointer, context, SNAP / 2);
  if (wrong) return atWrong(connectState, wrong, context);
  return atState(connectState, pointer, context) ?? nowhere(worldOf(pointer, context));
}

function nowhere(to: Point): ConnectAim {
  return { to, legal: null, target: null, message: null, plan: () => null };
}

function atPort(visible: ConnectPorts, port: VisiblePort, context: ToolContext): ConnectAim {
  const key = keyOf(port.element);
  const ends = visible.legal.get(key);
  return {
    to: port.at,
    legal: true,
    target: key,
    message: isData(port.element) ? `To ${described(context.machine, port.element)}` : null,
    plan: () => (ends ? connect(context.machine, ends.from, ends.to) : null),
  };
}

/** Target at a port where the line may not end, unless the existing transition of its outcome can be led there. */
function atWrong({ from }: ConnectState, port: VisiblePort, { machine }: ToolContext): ConnectAim {
  const led = ledElsewhere(machine, from, port.element);
  if (led) {
    const message = leadsFrom(machine, from);
    return { to: port.at, legal: true, target: keyOf(port.element), message, plan: () => led };
  }
  const ends = endsBetween(machine, from, port.element);
  const message = isLegal(ends) ? null : ends.refused;
  const plan = () => (isLegal(ends) ? null : ends);
  return { to: port.at, legal: false, target: keyOf(port.element), message, plan };
}

/** Target at another state than the first one, except the container in which the line is drawn. */
function atState(
  connectState: ConnectState,
  pointer: Pointer,
  context: ToolContext,
): ConnectAim | null {
  const { from } = connectState;
  const { machine, layout, camera } = context;
  const under = statesAt(layout, machine, camera, pointer).at(-1);
  const path = under === undefined ? null : ownState(machine, under);
  if (path === null || path === from.path) return null;
  if (isWithin(from.path, path) && !isAtBorder(from, path, pointer, context)) return null;
  const led = ledElsewhere(machine, from, { kind: "state", path });
  const plan = led ?? connectToState(machine, from, path);
  return {
    to: worldOf(pointer, context),
    legal: !isRefused(plan),
    target: keyOf({ kind: "state", path }),
    message: led
      ? leadsFrom(machine, from)
      : isRefused(plan)
        ? plan.refused
        : additionInWords(plan, machine.state(path)?.name ?? path),
    plan: () => plan,
  };
}

function leadsFrom(machine: Machine, from: CanvasPort): string {
  return `Leads the transition of “${nameOf(machine, from)}” here`;
}

/** True at the border of the surrounding container, where a line ends in a new port of the container. */
function isAtBorder(
  from: CanvasPort,
  path: string,
  pointer: Pointer,
  context: ToolContext,
): boolean {
  const box = parentOf(from.path) === path ? context.layout.box(path) : undefined;
  return box !== undefined && gripAt(screenBox(context.camera, box), pointer, 12) !== null;
}

/** Message about the port or outcome that a connection to a state adds there. */
function additionInWords(plan: Plan, name: string): string {
  const edits = editsOf(plan.edit);
  const port = edits.find((edit) => edit.edit === "add_port");
  const outcome = edits.find((edit) => edit.edit === "add_outcome");
  if (outcome) return `Adds the outcome “${outcome.name}” to “${name}”`;
  return port
    ? `Adds the ${port.list.replace("_", " ")} “${port.name}” to “${name}”`
    : `To “${name}”`;
}

/** Target by number, in the order of the keyboard: the nearest first, the first state last. */
function chosen(
  before: ConnectState,
  number: number,
  pointer: Pointer,
  context: ToolContext,
): Gesture {
  const connectState = current(before, context);
  const { visible, at, from } = connectState;
  const fitting = visible.ports
    .filter(({ element }) => visible.legal.has(keyOf(element)))
    .sort(nearerTo(at, from.path));
  const index = fitting.length === 0 ? 0 : (number + fitting.length) % fitting.length;
  const port = fitting[index];
  if (!port) {
    return shown(
      connectState,
      { ...nowhere(at), message: whyNone(connectState, context) },
      pointer,
      context,
      0,
    );
  }
  const there = screenFromWorld(context.camera, port.at);
  const owner = context.machine.state(port.element.path)?.name ?? port.element.path;
  const message = `To ${port.name} of “${owner}”: Enter connects, arrow keys choose another`;
  const aim = { ...atPort(visible, port, context), message };
  return shown(connectState, aim, { ...pointer, ...there }, context, index);
}

/** Reason why the keyboard finds no target: the refusal for the nearest port of another state. */
function whyNone({ from, visible, at }: ConnectState, { machine }: ToolContext): string {
  const [nearest] = visible.ports
    .filter(({ element }) => element.path !== from.path)
    .sort((one, other) => square(one.at, at) - square(other.at, at));
  const ends = nearest && endsBetween(machine, from, nearest.element);
  if (ends && !isLegal(ends)) return ends.refused;
  return "Nothing in view can be connected. Zoom out or point at a state.";
}

function square(one: Point, other: Point): number {
  return (one.x - other.x) ** 2 + (one.y - other.y) ** 2;
}

/** Plan with the waypoints that were set on the way, if it makes one connection. */
function withWaypoints(
  plan: Planned,
  { through, from }: ConnectState,
  { layout }: ToolContext,
): Planned {
  if (isRefused(plan) || through.length === 0) return plan;
  const edits = editsOf(plan.edit);
  const [only, another] = edits.filter(
    (edit) => edit.edit === "add_transition" || edit.edit === "add_data_flow",
  );
  if (!only || another) return plan;
  const points = through.map((at) => inState(layout, only.path, at));
  const waypoints = (endsAt(only, from) ? points.reverse() : points).map(
    ({ x, y }): [number, number] => [x, y],
  );
  const element =
    only.edit === "add_transition"
      ? { transition: only.transition }
      : { data_flow: only.data_flow };
  const set: Edit = { edit: "set_waypoints", path: only.path, element, waypoints };
  return { ...plan, edit: together([...edits, set]) };
}

/** True if the connection ends at the port where the user began to draw it, because it was drawn backwards. */
function endsAt(
  made: Extract<Edit, { readonly edit: "add_transition" | "add_data_flow" }>,
  from: CanvasPort,
): boolean {
  const id = "id" in from ? from.id : null;
  if (made.edit === "add_data_flow") {
    return made.to.port === id && made.to.state === idOf(from.path);
  }
  if ("outcome" in made.to) return made.path === from.path && made.to.outcome === id;
  return from.kind === "income" && made.to.state === idOf(from.path);
}
