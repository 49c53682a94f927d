/** Keys on the canvas without an active gesture: they walk along the graph, enter and leave states, and move the selection. */

import type { ElementRef } from "../model/element.ts";
import type { Box, Point } from "../model/geometry.ts";
import { parentOf } from "../model/path.ts";
import { select, selected, selectedStates } from "../store/page/view.ts";
import { filling } from "./camera/framing.ts";
import type { InteractionController, InteractionHost } from "./interaction.ts";
import { type Direction, entrance, portWalk, walked } from "./tools/walk.ts";
import { filledBy } from "./tools/working_container.ts";

/** A pressed key, with its name as in `KeyboardEvent.key`. */
export interface KeyPress {
  readonly key: string;
  readonly shift: boolean;
  readonly ctrl: boolean;
  readonly alt: boolean;
}

const ARROWS: Readonly<
  Record<string, { readonly direction: Direction; readonly by: Point } | undefined>
> = {
  ArrowRight: { direction: "next", by: { x: 1, y: 0 } },
  ArrowLeft: { direction: "previous", by: { x: -1, y: 0 } },
  ArrowDown: { direction: "in", by: { x: 0, y: 1 } },
  ArrowUp: { direction: "out", by: { x: 0, y: -1 } },
};

/** True if the key moves the selection by a step, or is a modifier for that. */
export function isNudge({ key, ctrl, alt, shift }: KeyPress): boolean {
  if (key === "Control" || key === "Alt" || key === "Meta") return true;
  return ARROWS[key] !== undefined && (ctrl || alt) && !shift;
}

/** Runs the action of the key; false if the canvas does not use it. */
export function handleKey(
  controller: InteractionController,
  host: InteractionHost,
  key: KeyPress,
): boolean {
  if (key.key === "Escape") return leaveLevel(controller, host);
  if (key.key === "Enter") return enter(controller, host);
  if (key.key === "Tab") return portStep(controller, host, key.shift ? -1 : 1);
  const arrow = ARROWS[key.key];
  if (!arrow || key.shift) return false;
  if (key.ctrl || key.alt) return nudge(controller, host, arrow.by, key.alt);
  return walk(controller, host, arrow.direction);
}

/** Clears the selection, or else goes one level out. */
function leaveLevel(controller: InteractionController, host: InteractionHost): boolean {
  const { view } = host.tab;
  if (view.selection.peek().size > 0) {
    select(view, []);
    return true;
  }
  const outer = farther(controller, host);
  if (outer === null) return false;
  controller.fit([outer]);
  return true;
}

/** Nearest outer state with a smaller scale of the camera. A library and its content fill one area, so a step between them would
 * not be visible. */
function farther(controller: InteractionController, host: InteractionHost): string | null {
  const camera = host.heading();
  let outer = parentOf(filledBy({ ...controller.toolContext(), camera }));
  while (outer !== null && !isFarther(controller.layout().box(outer), host))
    outer = parentOf(outer);
  return outer;
}

function isFarther(box: Box | undefined, host: InteractionHost): boolean {
  const fit = box && filling([box], host.size());
  return !!fit && fit.scale < host.heading().scale * 0.95;
}

function enter(controller: InteractionController, { tab }: InteractionHost): boolean {
  const [path] = selectedStates(tab.view);
  if (path === undefined) return false;
  controller.drill(path);
  const inside = entrance(tab.session.machine, controller.layout(), path);
  if (inside) select(tab.view, [inside]);
  return true;
}

function portStep(
  controller: InteractionController,
  { tab }: InteractionHost,
  by: 1 | -1,
): boolean {
  const [from] = selected(tab.view);
  const to = from && portWalk(controller.layout(), from, by);
  if (!to) return false;
  select(tab.view, [to]);
  return true;
}

/** Selects the next element in a direction, and scrolls it into view. */
function walk(
  controller: InteractionController,
  { tab }: InteractionHost,
  direction: Direction,
): boolean {
  const { machine } = tab.session;
  const from = selected(tab.view).at(-1);
  const workingContainer: ElementRef = { kind: "state", path: controller.workingContainer.peek() };
  const to = from
    ? walked(machine, controller.layout(), from, direction)
    : (entrance(machine, controller.layout(), workingContainer.path) ?? workingContainer);
  if (to) {
    select(tab.view, [to]);
    controller.reveal(to);
  }
  return true;
}

/** Moves the selected states by one step; with Alt by a tenth of a step. */
function nudge(
  controller: InteractionController,
  { tab }: InteractionHost,
  by: Point,
  isFine: boolean,
): boolean {
  const paths = selectedStates(tab.view);
  const parent = paths[0] === undefined ? null : parentOf(paths[0]);
  const box = parent === null ? undefined : controller.layout().box(parent);
  if (!box || parent === null) return false;
  const whole = Math.min(box.width, box.height) / controller.layout().unit(parent);
  const step = whole / (isFine ? 500 : 50);
  controller.nudge(paths, { x: by.x * step, y: by.y * step });
  return true;
}
