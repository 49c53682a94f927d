/** Queries for children near an area, without a scan of all children. */

import type { Box, Point } from "../../model/geometry.ts";
import type { Camera } from "../../store/page/view.ts";
import { worldFromScreen } from "../camera/camera.ts";
import type { LayoutTree, NodeFrame } from "../layout/layout_tree.ts";

/** Children that a box in the root's coordinates touches, in drawing order. */
export function childrenIn(layout: LayoutTree, path: string, area: Box): readonly string[] {
  const frame = layout.frame(path);
  const found: string[] = [];
  frame?.at.eachChild(inFrame(frame, area), (child) => found.push(child.path));
  return found;
}

/** Converts a box from the root's coordinates to those inside a state. */
export function inFrame(frame: NodeFrame, area: Box): Box {
  return {
    x: (area.x - frame.x) / frame.unit,
    y: (area.y - frame.y) / frame.unit,
    width: area.width / frame.unit,
    height: area.height / frame.unit,
  };
}

/** Box around a point of the view, in the root's coordinates. Point and reach are in CSS pixels. */
export function reachOf(camera: Camera, point: Point, reach: number): Box {
  const at = worldFromScreen(camera, point);
  const around = reach / camera.scale;
  return { x: at.x - around, y: at.y - around, width: 2 * around, height: 2 * around };
}
