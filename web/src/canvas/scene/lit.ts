/** What lights up with what the pointer is on: where an outcome leads, all that a port feeds and is fed by, over every level. */

import { type ElementKey, type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import { parentOf } from "../../model/path.ts";
import type { Line } from "../lines.ts";
import type { Placed } from "../placed.ts";

const NOTHING: ReadonlySet<ElementKey> = new Set();

/** Keys of the ports, connections and states that belong to what is hovered. */
export function litBy(placed: Placed, hovered: ElementRef | null): ReadonlySet<ElementKey> {
  switch (hovered?.kind) {
    case "outcome":
      return onwards(placed, [keyOf(hovered)]);
    case "transition":
    case "data_flow":
      return alongLine(placed, hovered);
    case "input":
    case "output":
    case "scoped_variable":
      return throughout(placed, keyOf(hovered));
    default:
      return NOTHING;
  }
}

function alongLine(placed: Placed, hovered: ElementRef): ReadonlySet<ElementKey> {
  const key = keyOf(hovered);
  const line = linesIn(placed, hovered.path).find((each) => each.key === key);
  if (!line) return NOTHING;
  if (line.kind === "data_flow") return throughout(placed, line.from);
  return new Set([key, line.from, ...onwards(placed, [line.to])]);
}

/** From an outcome to the state that runs next, out of as many containers as it takes. */
function onwards(placed: Placed, from: readonly ElementKey[]): ReadonlySet<ElementKey> {
  const lit = new Set<ElementKey>();
  const open = [...from];
  for (let key = open.pop(); key !== undefined; key = open.pop()) {
    if (lit.has(key)) continue;
    lit.add(key);
    for (const line of linesFrom(placed, key)) {
      lit.add(line.key);
      open.push(line.to);
    }
  }
  return lit;
}

function linesFrom(placed: Placed, port: ElementKey): readonly Line[] {
  const element = elementOf(port);
  const container = element?.kind === "outcome" ? parentOf(element.path) : null;
  if (container === null) return [];
  return linesIn(placed, container).filter((line) => line.from === port);
}

/** Everything that data flows join with the port, in both directions. */
function throughout(placed: Placed, port: ElementKey): ReadonlySet<ElementKey> {
  return new Set([...flowed(placed, port, "from", "to"), ...flowed(placed, port, "to", "from")]);
}

function flowed(
  placed: Placed,
  port: ElementKey,
  here: "from" | "to",
  there: "from" | "to",
): ReadonlySet<ElementKey> {
  const lit = new Set<ElementKey>();
  const open = [port];
  for (let key = open.pop(); key !== undefined; key = open.pop()) {
    if (lit.has(key)) continue;
    lit.add(key);
    for (const line of flowsAt(placed, key)) {
      if (line[here] !== key) continue;
      lit.add(line.key);
      open.push(line[there]);
    }
  }
  return lit;
}

/** Data flows of the two containers that a port belongs to: around its state, and inside it. */
function flowsAt(placed: Placed, port: ElementKey): readonly Line[] {
  const path = elementOf(port)?.path;
  if (path === undefined) return [];
  const outer = parentOf(path);
  const lines = outer === null ? [] : linesIn(placed, outer);
  return [...lines, ...linesIn(placed, path)].filter((line) => line.kind === "data_flow");
}

function linesIn(placed: Placed, path: string): readonly Line[] {
  return placed.frame(path)?.at.lines ?? [];
}
