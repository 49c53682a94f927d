/** What keys do on the canvas while no gesture is under way: along the graph, into states and out of them, a step aside. */

import type { ElementRef } from "../model/element.ts";
import type { Box, Point } from "../model/geometry.ts";
import { parentOf } from "../model/path.ts";
import { select, selected, selectedStates } from "../store/view.ts";
import type { Desk, Hand } from "./hand.ts";
import { filling } from "./looks.ts";
import { filledBy } from "./tools/stage.ts";
import { type Direction, entrance, portWalk, walked } from "./tools/walk.ts";

/** A key that was pressed, by the name that browsers give it. */
export interface Key {
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

/** Whether the key is a step of what is selected, or held for one. */
export function isNudge({ key, ctrl, alt, shift }: Key): boolean {
  if (key === "Control" || key === "Alt" || key === "Meta") return true;
  return ARROWS[key] !== undefined && (ctrl || alt) && !shift;
}

/** Does what the key is for; false if the canvas has no use for it. */
export function keyed(hand: Hand, desk: Desk, key: Key): boolean {
  if (key.key === "Escape") return leaveLevel(hand, desk);
  if (key.key === "Enter") return enter(hand, desk);
  if (key.key === "Tab") return portStep(hand, desk, key.shift ? -1 : 1);
  const arrow = ARROWS[key.key];
  if (!arrow || key.shift) return false;
  if (key.ctrl || key.alt) return nudge(hand, desk, arrow.by, key.alt);
  return walk(hand, desk, arrow.direction);
}

/** First the selection goes, then one is one level farther out. */
function leaveLevel(hand: Hand, desk: Desk): boolean {
  const { view } = desk.tab;
  if (view.selection.peek().size > 0) {
    select(view, []);
    return true;
  }
  const outer = farther(hand, desk);
  if (outer === null) return false;
  hand.fit([outer]);
  return true;
}

/** The nearest state around where one is that is seen from farther away: a library and its content fill the same room. */
function farther(hand: Hand, desk: Desk): string | null {
  const camera = desk.heading();
  let outer = parentOf(filledBy({ ...hand.around(), camera }));
  while (outer !== null && !isFarther(hand.places().box(outer), desk)) outer = parentOf(outer);
  return outer;
}

function isFarther(box: Box | undefined, desk: Desk): boolean {
  const fit = box && filling([box], desk.size());
  return !!fit && fit.scale < desk.heading().scale * 0.95;
}

function enter(hand: Hand, { tab }: Desk): boolean {
  const [path] = selectedStates(tab.view);
  if (path === undefined) return false;
  hand.drill(path);
  const inside = entrance(tab.session.machine, hand.places(), path);
  if (inside) select(tab.view, [inside]);
  return true;
}

function portStep(hand: Hand, { tab }: Desk, by: 1 | -1): boolean {
  const [from] = selected(tab.view);
  const to = from && portWalk(hand.places(), from, by);
  if (!to) return false;
  select(tab.view, [to]);
  return true;
}

/** Selects what follows in a direction, and brings it into sight. */
function walk(hand: Hand, { tab }: Desk, direction: Direction): boolean {
  const { machine } = tab.session;
  const from = selected(tab.view).at(-1);
  const stage: ElementRef = { kind: "state", path: hand.stage.peek() };
  const to = from
    ? walked(machine, hand.places(), from, direction)
    : (entrance(machine, hand.places(), stage.path) ?? stage);
  if (to) {
    select(tab.view, [to]);
    hand.reveal(to);
  }
  return true;
}

/** Moves the selected states by a step, with Alt by a tenth of it. */
function nudge(hand: Hand, { tab }: Desk, by: Point, isFine: boolean): boolean {
  const paths = selectedStates(tab.view);
  const parent = paths[0] === undefined ? null : parentOf(paths[0]);
  const box = parent === null ? undefined : hand.places().box(parent);
  if (!box || parent === null) return false;
  const whole = Math.min(box.width, box.height) / hand.places().unit(parent);
  const step = whole / (isFine ? 500 : 50);
  hand.nudge(paths, { x: by.x * step, y: by.y * step });
  return true;
}
