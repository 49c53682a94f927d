/** What is drawn, as far as it can be hit. */

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
import type { Route } from "../layout.ts";
import { extent } from "../scene/detail.ts";
import type { CanvasLook } from "./look.ts";

/** How large a box of the root's coordinates is on the screen, as `scene` counts it. */
export function extentOn(camera: Camera, { width, height }: Size): number {
  return extent({ width: width * camera.scale, height: height * camera.scale });
}

interface Shown {
  readonly machine: Machine;
  readonly look: CanvasLook;
}

/** Whether a port is drawn: aborted and preempted hide while nothing is connected to them and nobody looks at the state. */
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

/** Whether a connection is drawn in the current mode, and not only while the pointer is over one of its ends. */
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
