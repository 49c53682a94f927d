/** Elements of a machine that can be selected, hovered and connected. */

import type { Element } from "./generated/protocol.ts";

/** A state, one of its ports, or one of its connections. `path` is the path of the owning state; for connections the container. */
export type ElementRef =
  | { readonly kind: "state"; readonly path: string }
  | { readonly kind: "income"; readonly path: string }
  | {
      readonly kind:
        | "outcome"
        | "input"
        | "output"
        | "scoped_variable"
        | "transition"
        | "data_flow";
      readonly path: string;
      readonly id: number;
    };

export type ElementKind = ElementRef["kind"];

/** Unique text of an element, for sets and maps: `state:A/B`, `outcome:A/B:-1`. */
export type ElementKey = string;

export function keyOf(element: ElementRef): ElementKey {
  return "id" in element
    ? `${element.kind}:${element.path}:${element.id}`
    : `${element.kind}:${element.path}`;
}

const PLAIN = new Set(["state", "income"]);
const NUMBERED = new Set([
  "outcome",
  "input",
  "output",
  "scoped_variable",
  "transition",
  "data_flow",
]);

/** Element of a key; null if the key is invalid. */
export function elementOf(key: ElementKey): ElementRef | null {
  const start = key.indexOf(":");
  const kind = key.slice(0, start);
  if (PLAIN.has(kind)) return { kind, path: key.slice(start + 1) } as ElementRef;
  const end = key.lastIndexOf(":");
  if (!NUMBERED.has(kind) || end <= start) return null;
  return { kind, path: key.slice(start + 1, end), id: Number(key.slice(end + 1)) } as ElementRef;
}

/** Key of a state. */
export function stateKey(path: string): ElementKey {
  return `state:${path}`;
}

/** Name of the element in an edit of the layout. */
export function layoutElement(element: ElementRef): Element {
  switch (element.kind) {
    case "state":
    case "income":
      return element.kind;
    default:
      return { [element.kind]: element.id } as Element;
  }
}
