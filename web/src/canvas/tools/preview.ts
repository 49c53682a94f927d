/** What an edit would do to the drawing, as an overlay: so what a gesture shows is what it does. */

import { type ElementKey, type ElementRef, keyOf } from "../../model/element.ts";
import type { Edit, Element, StateDocument } from "../../model/generated/protocol.ts";
import type { Box, Point } from "../../model/geometry.ts";
import { portPlaces, readLayout } from "../../model/layout_reader.ts";
import { parentOf } from "../../model/path.ts";
import { isRefused, type Planned } from "../../plan/plan.ts";
import { NO_OVERLAY, type Overlay } from "../overlay.ts";
import { inState, type ToolContext } from "./gesture.ts";

interface PreviewDraft {
  readonly context: ToolContext;
  readonly boxes: Map<string, Box>;
  readonly names: Map<string, Box>;
  readonly ports: Map<ElementKey, Point>;
  readonly waypoints: Map<ElementKey, readonly Point[]>;
}

/** The overlay that shows where a plan puts things; nothing if it is refused. */
export function preview(planned: Planned, context: ToolContext): Overlay {
  if (isRefused(planned)) return NO_OVERLAY;
  const draft: PreviewDraft = {
    context,
    boxes: new Map(),
    names: new Map(),
    ports: new Map(),
    waypoints: new Map(),
  };
  show(planned.edit, draft);
  const { boxes, names, ports, waypoints } = draft;
  return { ...NO_OVERLAY, boxes, names, ports, waypoints };
}

function show(edit: Edit, draft: PreviewDraft): void {
  switch (edit.edit) {
    case "batch":
      for (const each of edit.edits) show(each, draft);
      return;
    case "set_position":
      placed(draft, edit.path, edit.element, { x: edit.position[0], y: edit.position[1] });
      return;
    case "set_size":
      sized(draft, edit.path, edit.element, edit.size);
      return;
    case "set_waypoints":
      draft.waypoints.set(
        keyOf(partOf(edit.path, edit.element)),
        edit.waypoints.map(([x, y]) => ({ x, y })),
      );
      return;
    case "set_layout":
      laidOut(draft, edit.path, edit.layout);
      return;
    default:
      return;
  }
}

/** The element that an edit of the layout names. */
function partOf(path: string, element: Element): ElementRef {
  if (element === "state" || element === "name") return { kind: "state", path };
  if (element === "income") return { kind: "income", path };
  const [kind, id] = Object.entries(element)[0] as [
    Exclude<ElementRef["kind"], "state" | "income">,
    number,
  ];
  return { kind, path, id };
}

function placed(draft: PreviewDraft, path: string, element: Element, at: Point): void {
  if (element === "state") draft.boxes.set(path, { ...boxIn(draft, path), ...at });
  else if (element === "name") draft.names.set(path, { ...nameIn(draft, path), ...at });
  else draft.ports.set(keyOf(partOf(path, element)), at);
}

function sized(
  draft: PreviewDraft,
  path: string,
  element: Element,
  [width, height]: readonly [number, number],
): void {
  if (element === "state") draft.boxes.set(path, { ...boxIn(draft, path), width, height });
  else if (element === "name") draft.names.set(path, { ...nameIn(draft, path), width, height });
}

const NOWHERE: Box = { x: 0, y: 0, width: 0, height: 0 };

function boxIn({ context, boxes }: PreviewDraft, path: string): Box {
  return boxes.get(path) ?? boxInParent(context, path) ?? NOWHERE;
}

/** The box of a state in the coordinates of its container. */
export function boxInParent(context: ToolContext, path: string): Box | undefined {
  const box = context.layout.box(path);
  const parent = parentOf(path);
  if (!box || parent === null) return box;
  const unit = context.layout.unit(parent);
  const at = inState(context.layout, parent, box);
  return { ...at, width: box.width / unit, height: box.height / unit };
}

function nameIn({ context, names }: PreviewDraft, path: string): Box {
  const known = names.get(path);
  if (known) return known;
  const box = context.layout.name(path);
  if (!box) return NOWHERE;
  const unit = context.layout.unit(path);
  const at = inState(context.layout, path, box);
  return { ...at, width: box.width / unit, height: box.height / unit };
}

function laidOut(draft: PreviewDraft, path: string, layout: StateDocument["layout"]): void {
  const state = draft.context.machine.state(path);
  if (!state || !layout) return;
  const then = { ...state, layout };
  const { position, size, nameBox, waypoints } = readLayout(then);
  const box = { ...boxIn(draft, path), ...position, ...size };
  draft.boxes.set(path, box);
  if (nameBox) draft.names.set(path, nameBox);
  for (const port of portPlaces(then, path, box)) draft.ports.set(port.key, port.at);
  for (const [key, points] of waypoints) {
    const [, kind, id] = /^(transition|data_flow)(-?\d+)$/.exec(key) ?? [];
    if (kind) draft.waypoints.set(`${kind}:${path}:${id}`, points);
  }
}
