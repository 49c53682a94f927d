/** States as documents with everything inside them: taken out of a machine, under other ids, in other sizes. */

import type { StateDocument } from "../model/generated/protocol.ts";
import { type Box, intersects, type Point } from "../model/geometry.ts";
import { changed, scaledBox, scaledLayout } from "../model/layout.ts";
import { childBox, rootSize } from "../model/layout_reader.ts";
import type { Machine } from "../model/machine.ts";
import { idOf, parentOf } from "../model/path.ts";
import { machineOf } from "../model/plain_machine.ts";
import { boxIn, childBoxes } from "./boxes.ts";

/** A state and its descendants, with paths from its id. The content of libraries is excluded. */
export function documentsOf(machine: Machine, path: string, id = idOf(path)): StateDocument[] {
  const state = machine.state(path);
  if (!state) return [];
  const children = state.kind === "library" ? [] : machine.children(path);
  const inner = children.flatMap((child) => documentsOf(machine, child, `${id}/${idOf(child)}`));
  return [{ ...state, path: id }, ...inner];
}

/** The same with the size in which it shows written into it. */
export function placedDocumentsOf(machine: Machine, path: string): StateDocument[] {
  const [first, ...rest] = documentsOf(machine, path);
  if (!first) return [];
  const box = boxIn(machine, path);
  return [{ ...first, layout: changed(first.layout, { position: box, size: box }) }, ...rest];
}

/** The same states under another id for the first; what connects its content with itself follows. */
export function underId(states: readonly StateDocument[], id: string): StateDocument[] {
  const old = states[0]?.path ?? "";
  const [before, now] = [idOf(old), idOf(id)];
  const renamed = (end: string) => (end === before ? now : end);
  return states.map((state, index) => {
    const path = id + state.path.slice(old.length);
    if (index > 0) return { ...state, path };
    return {
      ...state,
      path,
      ...(state.transitions && {
        transitions: state.transitions.map((transition) =>
          transition.to_outcome == null ? transition : { ...transition, to_state: now },
        ),
      }),
      ...(state.data_flows && {
        data_flows: state.data_flows.map((flow) => ({
          ...flow,
          from_state: renamed(flow.from_state),
          to_state: renamed(flow.to_state),
        })),
      }),
    };
  });
}

/** The same states drawn into a box, with everything inside in proportion. */
export function drawnInto(states: readonly StateDocument[], box: Box): StateDocument[] {
  const [root] = states;
  if (!root) return [];
  const size = rootSize(root);
  const factor = { x: box.width / size.width, y: box.height / size.height };
  const machine = machineOf({ header: { creation_time: "" }, states: [...states] });
  const boxes = new Map([[root.path, box]]);
  return states.map((state) => {
    for (const [path, inner] of childBoxes(machine, state.path)) {
      boxes.set(path, scaledBox(inner, factor));
    }
    const own = boxes.get(state.path) ?? box;
    return { ...state, layout: scaledLayout(state, own, factor) };
  });
}

/** The states of a selection, each list with the descendants of its first state. */
export function separate(states: readonly StateDocument[]): readonly StateDocument[][] {
  const found: StateDocument[][] = [];
  for (const state of states) {
    if (parentOf(state.path) === null) found.push([state]);
    else found.at(-1)?.push(state);
  }
  return found;
}

/** Position of a copied state. */
export function drawnBox(state: StateDocument, index: number): Box {
  return childBox(state, index, { width: 100, height: 100 });
}

/** The point, moved until no new element has the position of an existing one. */
export function besides(at: Point, size: Box, taken: readonly Box[]): Point {
  const step = Math.min(size.width, size.height) * 0.1;
  let point = at;
  const covers = (box: Box) =>
    Math.abs(box.x - point.x) < step / 2 &&
    Math.abs(box.y - point.y) < step / 2 &&
    intersects(box, { ...size, ...point });
  for (let tries = 0; tries < 50 && taken.some(covers); tries++) {
    point = { x: point.x + step, y: point.y + step };
  }
  return point;
}
