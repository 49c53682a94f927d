/** What of a state's inside is near a place, without a look at all of it. */

import type { Box, Point } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";
import { worldFromScreen } from "../camera.ts";
import type { LayoutTree, NodeFrame } from "../layout_tree.ts";

/** The children that a box of the root's coordinates touches, in the order in which they are drawn. */
export function childrenIn(layout: LayoutTree, path: string, area: Box): readonly string[] {
  const frame = layout.frame(path);
  const found: string[] = [];
  frame?.at.eachChild(inFrame(frame, area), (child) => found.push(child.path));
  return found;
}

/** A box of the root's coordinates in those inside a state. */
export function inFrame(frame: NodeFrame, area: Box): Box {
  return {
    x: (area.x - frame.x) / frame.unit,
    y: (area.y - frame.y) / frame.unit,
    width: area.width / frame.unit,
    height: area.height / frame.unit,
  };
}

/** What is within reach of a point of the view, both in CSS pixels, in the root's coordinates. */
export function reachOf(camera: Camera, point: Point, reach: number): Box {
  const at = worldFromScreen(camera, point);
  const around = reach / camera.scale;
  return { x: at.x - around, y: at.y - around, width: 2 * around, height: 2 * around };
}
