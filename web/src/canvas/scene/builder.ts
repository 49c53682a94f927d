/** Builder of a scene: its input, its result until now, and helpers that all parts of the scene need. */

import type { ElementKey } from "../../model/element.ts";
import { elementOf } from "../../model/element.ts";
import type { Box } from "../../model/geometry.ts";
import type { LayoutNode } from "../layout/layout_node.ts";
import { highlightedBy } from "./highlight.ts";
import type { SceneInput } from "./input.ts";
import type { Label, SignGroup } from "./labels.ts";
import { type Layer, newLayer, type TextMark } from "./list.ts";

/** A state with its place on the screen. */
export interface SceneNode {
  readonly at: LayoutNode;
  /** Upper left corner and size, in CSS pixels. */
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  /** CSS pixels per unit inside the state. */
  readonly scale: number;
  readonly depth: number;
  /** Size that selects the level of detail. */
  readonly extent: number;
  readonly outer: SceneNode | null;
}

export class SceneBuilder {
  readonly input: SceneInput;
  readonly layers: Layer[] = [];
  readonly wanted: string[] = [];
  readonly soon: LayoutNode[] = [];
  readonly highlighted: ReadonlySet<ElementKey>;
  /** States in the focus of the user: selected, hovered, or with a selected part. */
  readonly focused: ReadonlySet<string>;
  readonly onlookers = new Map<string, number>();
  /** Plates of container names, which other names avoid. */
  readonly plates: Box[] = [];
  /** Signs and names of people, which avoid the names of states. */
  readonly signs: SignGroup[] = [];
  /** Optional names of ports and labels of connections. */
  readonly portNames: TextMark[] = [];
  /** Names of ports of small states. They have the lowest priority. */
  readonly smallPortNames: TextMark[] = [];
  readonly labels: Label[] = [];
  readonly width: number;
  readonly height: number;
  /** The innermost state that covers the view, with its whole border outside. */
  covering: SceneNode | null = null;
  /** Number of layers that the states of a gesture are raised by, to lie above all others. */
  lift = 0;
  unfinished = false;
  /** Value at the port under the pointer, shown in full. */
  pointed: { readonly x: number; readonly y: number; readonly text: string } | null = null;

  constructor(input: SceneInput) {
    this.input = input;
    this.width = input.view.width;
    this.height = input.view.height;
    this.highlighted = highlightedBy(input.layout, input.hovered);
    this.focused = focusedBy(input);
    input.people.forEach((person, index) => {
      for (const path of person.selection) this.onlookers.set(path, index);
    });
  }

  /** Layer of the states at this depth. */
  layer(depth: number): Layer {
    return this.#at(depth + this.lift);
  }

  /** Adds a layer above all others. */
  top(): Layer {
    return this.#at(this.layers.length);
  }

  #at(index: number): Layer {
    while (this.layers.length <= index) this.layers.push(newLayer());
    return this.layers[index] as Layer;
  }

  /** True if any part of a box is in the view, extended by a margin. */
  sees(x: number, y: number, width: number, height: number, around: number): boolean {
    return (
      x < this.width + around &&
      y < this.height + around &&
      x + width > -around &&
      y + height > -around
    );
  }

  /** Visible area with a margin, in the coordinates of a state. */
  area(node: SceneNode, around: number): Box {
    return {
      x: (-around - node.x) / node.scale,
      y: (-around - node.y) / node.scale,
      width: (this.width + 2 * around) / node.scale,
      height: (this.height + 2 * around) / node.scale,
    };
  }

  /** True if the state covers the view, with its whole border outside. */
  isCoveredBy({ x, y, width, height }: SceneNode): boolean {
    return x < 0 && y < 0 && x + width > this.width && y + height > this.height;
  }

  isSelected(key: ElementKey): boolean {
    return this.input.selection.has(key);
  }
}

function focusedBy({ selection, hovered }: SceneInput): ReadonlySet<string> {
  const paths = new Set<string>();
  for (const key of selection) {
    const element = elementOf(key);
    if (element && element.kind !== "transition" && element.kind !== "data_flow") {
      paths.add(element.path);
    }
  }
  if (hovered && hovered.kind !== "transition" && hovered.kind !== "data_flow") {
    paths.add(hovered.path);
  }
  return paths;
}

/** Background colour of a state, by depth. */
export function shade(depth: number): string {
  return SHADES[Math.min(depth, SHADES.length - 1)] ?? "shade0";
}

/** Background colours by depth. Deeper states use the last one. */
const SHADES = Array.from({ length: 10 }, (_, depth) => `shade${depth}`);
