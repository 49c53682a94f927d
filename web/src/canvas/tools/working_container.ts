/** State that the user works in: the one that fills the view. */

import { isContainer } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import { statesAt } from "../hit/hit.ts";
import type { ToolContext } from "./gesture.ts";

/** Innermost container or library that fills the view; the root if none does. */
export function workingContainerOf(context: ToolContext): string {
  return inMiddle(context).findLast((path) => isStage(path, context)) ?? context.machine.root;
}

/** Innermost state of any kind that fills the view; the root if none does. */
export function filledBy(context: ToolContext): string {
  return inMiddle(context).findLast((path) => fills(path, context)) ?? context.machine.root;
}

/** True if the user works in the state, rather than beside it. */
export function isStage(path: string, context: ToolContext): boolean {
  if (parentOf(path) === null) return true;
  const state = context.machine.state(path);
  if (!state || !(isContainer(state) || state.kind === "library")) return false;
  return fills(path, context);
}

function inMiddle({ size, machine, layout, camera }: ToolContext): readonly string[] {
  return statesAt(layout, machine, camera, { x: size.width / 2, y: size.height / 2 });
}

function fills(path: string, { layout, camera, size }: ToolContext): boolean {
  const box = layout.box(path);
  if (!box) return false;
  return (
    box.width * camera.scale >= size.width * 0.8 || box.height * camera.scale >= size.height * 0.8
  );
}
