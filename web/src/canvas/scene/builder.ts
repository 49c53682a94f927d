/** The builder of a scene: what is given, what has been found so far, and small things that all parts of the scene need. */

import type { ElementKey } from "../../model/element.ts";
import { elementOf } from "../../model/element.ts";
import type { Box } from "../../model/geometry.ts";
import type { LayoutNode } from "../layout_node.ts";
import type { SceneInput } from "./input.ts";
import type { Label, SignGroup } from "./labels.ts";
import { type Layer, newLayer, type TextMark } from "./list.ts";
import { litBy } from "./lit.ts";

/** A state on its way to the screen. */
export interface SceneNode {
  readonly at: LayoutNode;
  /** Its left top corner and size in CSS pixels. */
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  /** CSS pixels for one of its own units. */
  readonly scale: number;
  readonly depth: number;
  /** The size that decides about detail. */
  readonly extent: number;
  readonly outer: SceneNode | null;
}

export class SceneBuilder {
  readonly input: SceneInput;
  readonly layers: Layer[] = [];
  readonly wanted: string[] = [];
  readonly soon: LayoutNode[] = [];
  readonly lit: ReadonlySet<ElementKey>;
  /** States that somebody looks at closely: selected, hovered, or with a selected part. */
  readonly focused: ReadonlySet<string>;
  readonly onlookers = new Map<string, number>();
  /** Plates of names of containers, which other names keep away from. */
  readonly plates: Box[] = [];
  /** Signs and names of people that keep off the names of states. */
  readonly signs: SignGroup[] = [];
  /** Names of ports, and labels of connections, that would be good to have. */
  readonly portNames: TextMark[] = [];
  /** Names of ports of small states, where all else leaves room. */
  readonly smallPortNames: TextMark[] = [];
  readonly labels: Label[] = [];
  readonly width: number;
  readonly height: number;
  /** The innermost state whose border is nowhere in the view. */
  covering: SceneNode | null = null;
  /** So many layers higher is drawn what a gesture holds: above all else. */
  lift = 0;
  unfinished = false;
  /** The value at the port under the pointer, which is told in full. */
  pointed: { readonly x: number; readonly y: number; readonly text: string } | null = null;

  constructor(input: SceneInput) {
    this.input = input;
    this.width = input.view.width;
    this.height = input.view.height;
    this.lit = litBy(input.layout, input.hovered);
    this.focused = focusedBy(input);
    input.people.forEach((person, index) => {
      for (const path of person.selection) this.onlookers.set(path, index);
    });
  }

  /** The layer of the states of this depth. */
  layer(depth: number): Layer {
    return this.#at(depth + this.lift);
  }

  /** A new layer above all that is there. */
  top(): Layer {
    return this.#at(this.layers.length);
  }

  #at(index: number): Layer {
    while (this.layers.length <= index) this.layers.push(newLayer());
    return this.layers[index] as Layer;
  }

  /** Whether any of a box can be seen, with so much around it. */
  sees(x: number, y: number, width: number, height: number, around: number): boolean {
    return (
      x < this.width + around &&
      y < this.height + around &&
      x + width > -around &&
      y + height > -around
    );
  }

  /** What can be seen, with so much around it, in the coordinates of a state. */
  area(node: SceneNode, around: number): Box {
    return {
      x: (-around - node.x) / node.scale,
      y: (-around - node.y) / node.scale,
      width: (this.width + 2 * around) / node.scale,
      height: (this.height + 2 * around) / node.scale,
    };
  }

  /** Whether nothing of the state's border is in the view. */
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

/** The ink of the ground of a state, by depth. */
export function shade(depth: number): string {
  return SHADES[Math.min(depth, SHADES.length - 1)] ?? "shade0";
}

/** So many depths are told apart. */
const SHADES = Array.from({ length: 10 }, (_, depth) => `shade${depth}`);
