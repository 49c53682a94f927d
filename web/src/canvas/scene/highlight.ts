/** Elements that light up with the hovered element: the target of an outcome, or all sources and targets of a port, across all
 * levels. */

import { type ElementKey, type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import { parentOf } from "../../model/path.ts";
import type { LayoutTree } from "../layout/layout_tree.ts";
import type { RoutedLine } from "../layout/lines.ts";

const NOTHING: ReadonlySet<ElementKey> = new Set();

/** Keys of the ports, connections and states that belong to the hovered element. */
export function highlightedBy(
  layout: LayoutTree,
  hovered: ElementRef | null,
): ReadonlySet<ElementKey> {
  switch (hovered?.kind) {
    case "outcome":
      return onwards(layout, [keyOf(hovered)]);
    case "transition":
    case "data_flow":
      return alongLine(layout, hovered);
    case "input":
    case "output":
    case "scoped_variable":
      return throughout(layout, keyOf(hovered));
    default:
      return NOTHING;
  }
}

function alongLine(layout: LayoutTree, hovered: ElementRef): ReadonlySet<ElementKey> {
  const key = keyOf(hovered);
  const line = linesIn(layout, hovered.path).find((each) => each.key === key);
  if (!line) return NOTHING;
  if (line.kind === "data_flow") return throughout(layout, line.from);
  return new Set([key, line.from, ...onwards(layout, [line.to])]);
}

/** From an outcome to the state that runs next, across any number of containers. */
function onwards(layout: LayoutTree, from: readonly ElementKey[]): ReadonlySet<ElementKey> {
  const highlighted = new Set<ElementKey>();
  const open = [...from];
  for (let key = open.pop(); key !== undefined; key = open.pop()) {
    if (highlighted.has(key)) continue;
    highlighted.add(key);
    for (const line of linesFrom(layout, key)) {
      highlighted.add(line.key);
      open.push(line.to);
    }
  }
  return highlighted;
}

function linesFrom(layout: LayoutTree, port: ElementKey): readonly RoutedLine[] {
  const element = elementOf(port);
  const container = element?.kind === "outcome" ? parentOf(element.path) : null;
  if (container === null) return [];
  return linesIn(layout, container).filter((line) => line.from === port);
}

/** All elements that data flows connect to the port, in both directions. */
function throughout(layout: LayoutTree, port: ElementKey): ReadonlySet<ElementKey> {
  return new Set([...flowed(layout, port, "from", "to"), ...flowed(layout, port, "to", "from")]);
}

function flowed(
  layout: LayoutTree,
  port: ElementKey,
  here: "from" | "to",
  there: "from" | "to",
): ReadonlySet<ElementKey> {
  const highlighted = new Set<ElementKey>();
  const open = [port];
  for (let key = open.pop(); key !== undefined; key = open.pop()) {
    if (highlighted.has(key)) continue;
    highlighted.add(key);
    for (const line of flowsAt(layout, key)) {
      if (line[here] !== key) continue;
      highlighted.add(line.key);
      open.push(line[there]);
    }
  }
  return highlighted;
}

/** Data flows in the two containers of a port: around its state, and inside it. */
function flowsAt(layout: LayoutTree, port: ElementKey): readonly RoutedLine[] {
  const path = elementOf(port)?.path;
  if (path === undefined) return [];
  const outer = parentOf(path);
  const lines = outer === null ? [] : linesIn(layout, outer);
  return [...lines, ...linesIn(layout, path)].filter((line) => line.kind === "data_flow");
}

function linesIn(layout: LayoutTree, path: string): readonly RoutedLine[] {
  return layout.frame(path)?.at.lines ?? [];
}
