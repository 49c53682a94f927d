/** Moves states: within their container along guide lines, into another container, or into a transition; with Alt as copies. */

import { keyOf } from "../../model/element.ts";
import { type Box, boundsOf, type Point } from "../../model/geometry.ts";
import { isContainer, transitionsOf } from "../../model/machine.ts";
import { idOf, isWithin, parentOf } from "../../model/path.ts";
import { duplicate, duplicateInto } from "../../plan/clipboard.ts";
import { insertState } from "../../plan/insert.ts";
import { counted } from "../../plan/legal.ts";
import { allowedMove, lostConnections, move, moveInto } from "../../plan/move.ts";
import { isRefused, type Planned, together } from "../../plan/plan.ts";
import { statesAt } from "../hit/hit.ts";
import { distanceToLine } from "../hit/lines.ts";
import type { Route } from "../layout/layout.ts";
import { NO_OVERLAY, type Overlay, showing } from "../overlay.ts";
import { editsOf } from "./edits.ts";
import {
  type Gesture,
  inState,
  minus,
  type Pointer,
  plus,
  type ToolContext,
  worldOf,
} from "./gesture.ts";
import { type Guides, neighbours, snapped } from "./guides.ts";

interface Moving {
  readonly paths: readonly string[];
  /** Point where the drag started, in the root's coordinates. */
  readonly from: Point;
  /** Container of the states; null if they have several. */
  readonly container: string | null;
  /** Bounds of all moved states. */
  readonly box: Box;
  readonly others: readonly Box[];
}

/** Starts to move states from the pressed point. None of them may be the root. */
export function moving(paths: readonly string[], pressed: Pointer, context: ToolContext): Gesture {
  const parents = new Set(paths.map(parentOf));
  const [parent] = parents;
  const container = parents.size === 1 && parent !== undefined ? parent : null;
  const boxes = paths.flatMap((path) => context.layout.box(path) ?? []);
  const start: Moving = {
    paths,
    from: worldOf(pressed, context),
    container,
    box: boundsOf(boxes) ?? { x: 0, y: 0, width: 0, height: 0 },
    others: container === null ? [] : neighbours(context, container, new Set(paths)),
  };
  return next(start, pressed, context);
}

interface MoveStep {
  readonly overlay: Overlay;
  readonly cursor?: string;
  readonly plan: () => Planned | null;
}

function next(start: Moving, pointer: Pointer, context: ToolContext): Gesture {
  const step = pointer.alt ? copy(start, pointer, context) : drop(start, pointer, context);
  return {
    name: "move",
    cursor: step.cursor ?? "grabbing",
    overlay: step.overlay,
    move: (to, then) => next(start, to, then),
    result: () => {
      const plan = step.plan();
      return plan ? { plan } : {};
    },
  };
}

function copy(start: Moving, pointer: Pointer, context: ToolContext): MoveStep {
  const target = containerAt(pointer, context, start.paths);
  if (target !== null && start.container !== null && target !== start.container) {
    return { cursor: "copy", ...intoContainer(start, target, pointer, context, "copy") };
  }
  const { by, guides } = dragOf(start, pointer, context);
  const overlay = { ...NO_OVERLAY, guides, ghosts: ghosts(start, by, context) };
  return {
    overlay,
    cursor: "copy",
    plan: () =>
      isNone(by) ? null : duplicate(context.machine, start.paths, inside(start, by, context)),
  };
}

function drop(start: Moving, pointer: Pointer, context: ToolContext): MoveStep {
  const target = containerAt(pointer, context, start.paths);
  if (target !== null && start.container !== null && target !== start.container) {
    return intoContainer(start, target, pointer, context, "move");
  }
  const line = lineUnder(start, pointer, context);
  return line ? intoLine(start, line, pointer, context) : within(start, pointer, context);
}

/** Movement within the container, along guide lines and not beyond the border. */
function within(start: Moving, pointer: Pointer, context: ToolContext): MoveStep {
  const { by, guides } = dragOf(start, pointer, context);
  if (isNone(by)) return { overlay: NO_OVERLAY, plan: () => null };
  const plan = move(context.machine, start.paths, inside(start, by, context));
  return { overlay: { ...showing(plan, new Set(start.paths)), guides }, plan: () => plan };
}

/** Movement of the boxes, in the root's coordinates. */
function dragOf(
  start: Moving,
  pointer: Pointer,
  context: ToolContext,
): { readonly by: Point; readonly guides: Guides } {
  const wanted = minus(worldOf(pointer, context), start.from);
  if (isNone(wanted)) return { by: wanted, guides: [] };
  const box = { ...start.box, x: start.box.x + wanted.x, y: start.box.y + wanted.y };
  const snap = pointer.ctrl
    ? { by: { x: 0, y: 0 }, guides: [] }
    : snapped(box, start.others, context);
  const to = plus(wanted, snap.by);
  const by = kept(start, to, context);
  // Leaves out guides that the states do not reach because of the border.
  const guides = snap.guides.filter(({ from, to: end }) =>
    from.x === end.x ? by.x === to.x : by.y === to.y,
  );
  return { by, guides };
}

/** Movement limited by the border of the container, in the root's coordinates. */
function kept(start: Moving, by: Point, context: ToolContext): Point {
  const { container, paths } = start;
  if (container === null) return by;
  const unit = context.layout.unit(container);
  const wanted = inside(start, by, context);
  const allowed = allowedMove(context.machine, paths, wanted);
  return {
    x: allowed.x === wanted.x ? by.x : allowed.x * unit,
    y: allowed.y === wanted.y ? by.y : allowed.y * unit,
  };
}

function isNone(by: Point): boolean {
  return by.x === 0 && by.y === 0;
}

/** Converts a movement from the root's coordinates to those of the container. */
function inside({ container }: Moving, by: Point, { layout }: ToolContext): Point {
  const unit = container === null ? 1 : layout.unit(container);
  return { x: by.x / unit, y: by.y / unit };
}

function ghosts({ paths }: Moving, by: Point, { layout }: ToolContext): readonly Box[] {
  return paths.flatMap((path) => {
    const box = layout.box(path);
    return box ? [{ ...box, ...plus(box, by) }] : [];
  });
}

/** Innermost container under the pointer that accepts states: not inside a moved state, and not in a library. */
export function containerAt(
  pointer: Point,
  context: ToolContext,
  moved: readonly string[],
): string | null {
  const { machine, layout, camera } = context;
  const found = statesAt(layout, machine, camera, pointer).findLast((path) => {
    const state = machine.state(path);
    if (!state || !isContainer(state) || machine.isInLibrary(path)) return false;
    return !moved.some((one) => isWithin(path, one)) && isRoomy(context, path);
  });
  return found ?? null;
}

/** True if a container is large enough for drops. In a smaller one the dropped state would not be visible. */
function isRoomy({ layout, camera }: ToolContext, path: string): boolean {
  const box = layout.box(path);
  return box !== undefined && Math.min(box.width, box.height) * camera.scale >= 40;
}

function intoContainer(
  start: Moving,
  target: string,
  pointer: Pointer,
  context: ToolContext,
  how: "move" | "copy",
): MoveStep {
  const { machine } = context;
  const by = minus(worldOf(pointer, context), start.from);
  const at = inState(context.layout, target, plus(start.box, by));
  const plan = (how === "copy" ? duplicateInto : moveInto)(machine, start.paths, target, at);
  const name = machine.state(target)?.name ?? target;
  const lost = how === "copy" ? 0 : lostConnections(machine, start.paths);
  const cost = lost === 0 ? "" : `; removes ${counted(lost, "connection")}`;
  const message = isRefused(plan)
    ? { at: pointer, text: plan.refused, bad: true }
    : {
        at: pointer,
        text: `${how === "copy" ? "Copy" : "Move"} into “${name}”${cost}`,
        bad: false,
      };
  const overlay = {
    ...NO_OVERLAY,
    drop: keyOf({ kind: "state", path: target }),
    ghosts: ghosts(start, by, context),
    message,
  };
  return isRefused(plan)
    ? { overlay, cursor: "not-allowed", plan: () => plan }
    : { overlay, plan: () => plan };
}

const LINE_REACH = 8;

/** Transition that a single state without transitions would be dropped into. */
function lineUnder(
  { paths, container }: Moving,
  pointer: Pointer,
  context: ToolContext,
): Route | null {
  const [path, ...others] = paths;
  if (path === undefined || others.length > 0 || container === null) return null;
  const routes = context.layout.routes(container);
  const near = routes.find(
    (route) =>
      route.kind === "transition" &&
      distanceToLine(route.points, pointer, context.camera) <= LINE_REACH &&
      !touches(route, path, context),
  );
  return near && !isConnected(path, container, context) ? near : null;
}

function touches(route: Route, path: string, { machine }: ToolContext): boolean {
  const state = machine.state(route.path);
  const one = state && transitionsOf(state).find(({ id }) => id === route.id);
  return one !== undefined && (one.from_state === idOf(path) || one.to_state === idOf(path));
}

function isConnected(path: string, container: string, { machine }: ToolContext): boolean {
  const state = machine.state(container);
  const id = idOf(path);
  return (
    state !== undefined &&
    transitionsOf(state).some((one) => one.from_state === id || one.to_state === id)
  );
}

function intoLine(start: Moving, route: Route, pointer: Pointer, context: ToolContext): MoveStep {
  const { by } = dragOf({ ...start, others: [] }, pointer, context);
  const [path = ""] = start.paths;
  const transition = { kind: "transition", path: route.path, id: route.id } as const;
  const at = inState(context.layout, route.path, plus(start.box, by));
  const plan = insertState(context.machine, transition, path, at);
  const moved = move(context.machine, [path], inside(start, by, context));
  if (isRefused(plan) || isRefused(moved)) return within(start, pointer, context);
  const both = { ...plan, edit: together([...editsOf(moved.edit), ...editsOf(plan.edit)]) };
  const overlay = {
    ...showing(moved, new Set([path])),
    drop: keyOf(transition),
    message: { at: pointer, text: "Insert into the transition", bad: false },
  };
  return { overlay, plan: () => both };
}
