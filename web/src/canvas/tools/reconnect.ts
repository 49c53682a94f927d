/** Drags an end of a connection to another port. Without a port at the release, the connection stays unchanged. */

import { type ElementKey, keyOf } from "../../model/element.ts";
import type { Point } from "../../model/geometry.ts";
import { reconnect } from "../../plan/connect.ts";
import { isRefused, type Planned } from "../../plan/plan.ts";
import { routeOf } from "../hit/hit.ts";
import type { LineRef } from "../hit/look.ts";
import { NO_OVERLAY, type Overlay } from "../overlay.ts";
import { type Gesture, type Pointer, type ToolContext, worldOf } from "./gesture.ts";
import { nearestPort, type VisiblePort, visiblePorts } from "./targets.ts";

const SNAP = 18;

interface Leading {
  readonly line: LineRef;
  readonly end: "from" | "to";
  /** Position of the other end, which stays. */
  readonly fixed: Point;
  readonly visible: ReconnectPorts;
}

interface ReconnectPorts {
  readonly camera: ToolContext["camera"];
  readonly version: number;
  readonly ports: readonly VisiblePort[];
  readonly plans: ReadonlyMap<ElementKey, Planned>;
}

/** Starts to drag an end of a connection. */
export function reconnecting(
  line: LineRef,
  end: "from" | "to",
  pointer: Pointer,
  context: ToolContext,
): Gesture {
  const points = routeOf(context.layout, line)?.points ?? [];
  const fixed = (end === "from" ? points.at(-1) : points[0]) ?? worldOf(pointer, context);
  return next({ line, end, fixed, visible: look(line, end, context) }, pointer, context);
}

function look(line: LineRef, end: "from" | "to", context: ToolContext): ReconnectPorts {
  const ports = visiblePorts(context, line.kind === "data_flow");
  const plans = new Map(
    ports.map(({ element }) => [keyOf(element), reconnect(context.machine, line, end, element)]),
  );
  return { camera: context.camera, version: context.machine.version, ports, plans };
}

function next(before: Leading, pointer: Pointer, context: ToolContext): Gesture {
  const { visible, line, end } = before;
  const isSame = visible.camera === context.camera && visible.version === context.machine.version;
  const leading = isSame ? before : { ...before, visible: look(line, end, context) };
  const aim = aimAt(leading, pointer, context);
  return {
    name: "reconnect",
    cursor: aim.legal === false ? "not-allowed" : "crosshair",
    overlay: overlayOf(leading, aim, pointer),
    move: (to, then) => next(leading, to, then),
    result: () => (aim.plan ? { plan: aim.plan } : {}),
  };
}

interface ReconnectAim {
  readonly to: Point;
  readonly legal: boolean | null;
  readonly target: ElementKey | null;
  readonly plan: Planned | null;
}

function aimAt({ visible }: Leading, pointer: Pointer, context: ToolContext): ReconnectAim {
  const legal = visible.ports.filter(({ element }) => isFine(visible, keyOf(element)));
  const port =
    nearestPort(legal, pointer, context, SNAP) ??
    nearestPort(visible.ports, pointer, context, SNAP / 2);
  if (!port) return { to: worldOf(pointer, context), legal: null, target: null, plan: null };
  const target = keyOf(port.element);
  return {
    to: port.at,
    legal: isFine(visible, target),
    target,
    plan: visible.plans.get(target) ?? null,
  };
}

function isFine({ plans }: ReconnectPorts, key: ElementKey): boolean {
  const plan = plans.get(key);
  return plan !== undefined && !isRefused(plan);
}

function overlayOf(
  { line, end, fixed, visible }: Leading,
  aim: ReconnectAim,
  pointer: Point,
): Overlay {
  const targets = new Map<ElementKey, boolean>();
  for (const [key, plan] of visible.plans) if (!isRefused(plan)) targets.set(key, true);
  if (aim.target !== null) targets.set(aim.target, aim.legal === true);
  const [from, to] = end === "to" ? [fixed, aim.to] : [aim.to, fixed];
  const { legal } = aim;
  const text = aim.plan && isRefused(aim.plan) ? aim.plan.refused : null;
  return {
    ...NO_OVERLAY,
    line: { from, to, through: [], data: line.kind === "data_flow", legal },
    targets,
    message: text === null ? null : { at: pointer, text, bad: true },
  };
}
