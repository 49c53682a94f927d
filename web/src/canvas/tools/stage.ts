/** The state that one works in: the one that fills the view. */

import { isContainer } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { statesAt } from "../hit/hit.ts";
import type { Around } from "./gesture.ts";

/** The innermost state that fills the view; the root if none does. */
export function stageOf(around: Around): string {
  const { size, machine, places, camera } = around;
  const middle = { x: size.width / 2, y: size.height / 2 };
  const line = statesAt(places, machine, camera, middle);
  return line.findLast((path) => isStage(path, around)) ?? machine.root;
}

/** Whether the state is what one works in now, and not one thing among others. */
export function isStage(path: string, { machine, places, camera, size }: Around): boolean {
  if (parentOf(path) === null) return true;
  const [state, box] = [machine.state(path), places.box(path)];
  if (!state || !box || !(isContainer(state) || state.kind === "library")) return false;
  return (
    box.width * camera.scale >= size.width * 0.8 || box.height * camera.scale >= size.height * 0.8
  );
}
