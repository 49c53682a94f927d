/** The tree as a gesture has it: states, ports and waypoints where they are held, all else as it was. */

import { elementOf } from "../model/element.ts";
import type { Box } from "../model/geometry.ts";
import type { PortPlace } from "../model/layout_reader.ts";
import { lineage, parentOf } from "../model/path.ts";
import { same } from "./grid.ts";
import { type LayoutNode, stretchedPorts } from "./layout_node.ts";
import type { Overlay } from "./overlay.ts";

/** The tree with what the overlay holds. */
export function withPreview(root: LayoutNode, overlay: Overlay): LayoutNode {
  const touched = touchedBy(overlay);
  return touched.size === 0 ? root : held(root, overlay, touched);
}

/** Paths of all states that are another object then: those held, and those around them. */
function touchedBy({ boxes, ports, waypoints }: Overlay): ReadonlySet<string> {
  const paths = [...boxes.keys()];
  for (const key of [...ports.keys(), ...waypoints.keys()]) {
    const element = elementOf(key);
    if (element) paths.push(element.path);
  }
  return new Set(paths.flatMap(lineage));
}

function held(state: LayoutNode, overlay: Overlay, touched: ReadonlySet<string>): LayoutNode {
  if (!touched.has(state.path)) return state;
  const box = boxIn(state, overlay);
  const grown = box && !same(box, state.box) ? resized(state, box, overlay) : state;
  const children = grown.children.map((child) => held(child, overlay, touched));
  const ports = grown.ports.map((port) => withPort(port, overlay));
  const before = overlay.scaled.has(state.path) ? grown : state;
  return grown.with({ children, ports }).after(before, overlay.waypoints);
}

/** The root stays in the corner of its own coordinates. */
function boxIn(state: LayoutNode, overlay: Overlay): Box | undefined {
  const box = overlay.boxes.get(state.path);
  return box && parentOf(state.path) === null ? { ...box, x: 0, y: 0 } : box;
}

function withPort(port: PortPlace, overlay: Overlay): PortPlace {
  const at = overlay.ports.get(port.key);
  return at ? { ...port, at } : port;
}

/** A state in another box: its ports keep their share of the border, its content stays or grows along. */
function resized(state: LayoutNode, box: Box, overlay: Overlay): LayoutNode {
  const { width, height } = state.box;
  if (box.width === width && box.height === height) {
    return state.with({ box, children: state.children, ports: state.ports, name: state.name });
  }
  const by = { x: box.width / (width || 1), y: box.height / (height || 1) };
  if (overlay.scaled.has(state.path)) return state.stretched(box, by);
  const ports = stretchedPorts(state.ports, by);
  return state.with({ box, ports, ...(state.opened ? {} : { children: state.children }) });
}
