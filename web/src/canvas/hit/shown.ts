/** Visibility of ports and connections, for the hit test. */

import { elementOf, keyOf } from "../../model/element.ts";
import type { Size } from "../../model/geometry.ts";
import type { PortPlace } from "../../model/layout_reader.ts";
import {
  ABORTED,
  dataFlowsOf,
  type Machine,
  PREEMPTED,
  transitionsOf,
} from "../../model/machine.ts";
import { childPath, idOf, parentOf } from "../../model/path.ts";
import type { Camera } from "../../store/page/view.ts";
import type { Route } from "../layout/layout.ts";
import { extent } from "../scene/detail.ts";
import type { CanvasLook } from "./look.ts";

/** Size on the screen of a box in the root's coordinates, by the measure of `scene`. */
export function extentOn(camera: Camera, { width, height }: Size): number {
  return extent({ width: width * camera.scale, height: height * camera.scale });
}

interface Shown {
  readonly machine: Machine;
  readonly look: CanvasLook;
}

/** True if a port is drawn. Aborted and preempted are hidden while they have no connection and their state is neither hovered nor
 * selected. */
export function isPortShown(port: PortPlace, path: string, { machine, look }: Shown): boolean {
  const isQuiet = port.kind === "outcome" && (port.id === ABORTED || port.id === PREEMPTED);
  if (!isQuiet || look.modes.aborted) return true;
  if (look.hovered?.path === path || isLookedAt(path, look)) return true;
  return hasTransition(machine, path, port.id);
}

function isLookedAt(path: string, look: CanvasLook): boolean {
  if (look.selection.has(keyOf({ kind: "state", path }))) return true;
  for (const key of look.selection) if (elementOf(key)?.path === path) return true;
  return false;
}

function hasTransition(machine: Machine, path: string, outcome: number): boolean {
  const parent = parentOf(path);
  const [container, own] = [parent === null ? undefined : machine.state(parent), idOf(path)];
  const leaves =
    container !== undefined &&
    transitionsOf(container).some((one) => one.from_state === own && one.from_outcome === outcome);
  const state = machine.state(path);
  return leaves || (!!state && transitionsOf(state).some((one) => one.to_outcome === outcome));
}

/** True if a connection is drawn in the current mode, and not only while one of its ends is hovered. */
export function isRouteShown(route: Route, { machine, look }: Shown): boolean {
  if (look.selection.has(keyOf(route))) return true;
  if (route.kind === "transition") return look.modes.transitions;
  if (look.modes.dataFlows !== "selection") return look.modes.dataFlows === "all";
  const container = machine.state(route.path);
  const flow = container && dataFlowsOf(container).find(({ id }) => id === route.id);
  if (!flow) return false;
  return [flow.from_state, flow.to_state].some((id) => {
    const path = id === idOf(route.path) ? route.path : childPath(route.path, id);
    return isLookedAt(path, look);
  });
}
