/** Drags an object from outside onto the canvas: a kind of state, or a library. */

import { keyOf } from "../../model/element.ts";
import type { Box, Point } from "../../model/geometry.ts";
import { readLayout } from "../../model/layout_reader.ts";
import { inside, lineRoom } from "../../plan/boxes.ts";
import { insertState } from "../../plan/insert.ts";
import { isRefused, type Planned } from "../../plan/plan.ts";
import { addState } from "../../plan/states.ts";
import type { Dragged } from "../../store/page/dragged.ts";
import { distanceToLine } from "../hit/lines.ts";
import type { Route } from "../layout/layout.ts";
import { NO_OVERLAY, type Overlay } from "../overlay.ts";
import { editsOf } from "./edits.ts";
import { type Gesture, inState, type Pointer, type ToolContext, worldOf } from "./gesture.ts";
import { containerAt } from "./move.ts";

/** Gesture while the object is over the canvas. */
export function bringing(brought: Dragged, pointer: Pointer, context: ToolContext): Gesture {
  const container = containerAt(pointer, context, []);
  const step =
    container === null ? refusedHere(pointer) : into(brought, container, pointer, context);
  return {
    name: "drop",
    cursor: "copy",
    overlay: step.overlay,
    move: (to, then) => bringing(brought, to, then),
    result: step.result,
  };
}

type DropStep = Pick<Gesture, "overlay" | "result">;

function refusedHere(pointer: Pointer): DropStep {
  const text = "States belong in hierarchies and concurrencies. Drop it on one of them.";
  const plan: Planned = { refused: text };
  return {
    overlay: { ...NO_OVERLAY, message: { at: pointer, text, bad: true } },
    result: () => ({ plan }),
  };
}

function into(
  brought: Dragged,
  container: string,
  pointer: Pointer,
  context: ToolContext,
): DropStep {
  const at = inState(context.layout, container, worldOf(pointer, context));
  const line = lineUnder(container, pointer, context);
  if ("insert" in brought) {
    const plan = line
      ? insertState(context.machine, lineRef(line), { kind: brought.insert }, at)
      : addState(context.machine, container, brought.insert, at);
    const drop = keyOf(line ? lineRef(line) : { kind: "state", path: container });
    return { overlay: planned(plan, container, drop, pointer, context), result: () => ({ plan }) };
  }
  const transition = line ? { transition: line.id } : {};
  const argument = { ...brought.library, container, at, ...transition };
  const drop = keyOf(line ? lineRef(line) : { kind: "state", path: container });
  const overlay = {
    ...NO_OVERLAY,
    drop,
    ghosts: [ghost(container, cornerAt(container, pointer, context), context)],
    message: { at: pointer, text: whereTo(drop, container, context), bad: false },
  };
  return { overlay, result: () => ({ run: { command: "insert.library", argument } }) };
}

function whereTo(drop: string, container: string, { machine }: ToolContext): string {
  if (drop.startsWith("transition:")) return "Insert into the transition";
  return `Into “${machine.state(container)?.name ?? container}”`;
}

function planned(
  plan: Planned,
  container: string,
  drop: string,
  pointer: Pointer,
  context: ToolContext,
): Overlay {
  if (isRefused(plan)) {
    return { ...NO_OVERLAY, drop, message: { at: pointer, text: plan.refused, bad: true } };
  }
  const added = editsOf(plan.edit).find((edit) => edit.edit === "add_state");
  const layout = added?.states[0] && readLayout(added.states[0]);
  const text = whereTo(drop, container, context);
  const at = layout?.position ?? cornerAt(container, pointer, context);
  const box = ghost(container, at, context, layout?.size);
  return { ...NO_OVERLAY, drop, ghosts: [box], message: { at: pointer, text, bad: false } };
}

/** Side of a new state: a fifth of the container's shorter side. */
function sideIn(container: string, { layout }: ToolContext): number {
  const box = layout.box(container);
  return box ? (Math.min(box.width, box.height) / layout.unit(container)) * 0.2 : 1;
}

/** Upper left corner of a new state that is centred at the pointer but entirely inside the container. */
function cornerAt(container: string, pointer: Pointer, context: ToolContext): Point {
  const { layout } = context;
  const middle = inState(layout, container, worldOf(pointer, context));
  const side = sideIn(container, context);
  const box = layout.box(container);
  const unit = layout.unit(container);
  const wanted = { x: middle.x - side / 2, y: middle.y - side / 2, width: side, height: side };
  const room = { width: (box?.width ?? 0) / unit, height: (box?.height ?? 0) / unit };
  return inside(wanted, room, lineRoom(room));
}

function ghost(
  container: string,
  at: Point,
  context: ToolContext,
  size?: { readonly width: number; readonly height: number },
): Box {
  const { layout } = context;
  const outer = layout.box(container) ?? { x: 0, y: 0 };
  const unit = layout.unit(container);
  const side = sideIn(container, context);
  return {
    x: outer.x + at.x * unit,
    y: outer.y + at.y * unit,
    width: (size?.width ?? side) * unit,
    height: (size?.height ?? side) * unit,
  };
}

function lineUnder(
  container: string,
  pointer: Pointer,
  { layout, camera }: ToolContext,
): Route | null {
  const near = layout
    .routes(container)
    .find(
      (route) => route.kind === "transition" && distanceToLine(route.points, pointer, camera) <= 8,
    );
  return near ?? null;
}

function lineRef({ path, id }: Route) {
  return { kind: "transition", path, id } as const;
}
