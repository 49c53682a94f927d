/** View of one open machine: selection, camera and layers. Local to this page. */

import { type Signal, signal } from "@preact/signals-core";
import { type ElementKey, type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import type { Size } from "../../model/geometry.ts";
import type { Machine } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";

/** Position of the view: the root's coordinates at the top left corner of the screen, and `scale` CSS pixels per unit of the root. */
export interface Camera {
  readonly x: number;
  readonly y: number;
  readonly scale: number;
}

export type FlowMode = "all" | "selection" | "none";

export interface ViewModes {
  readonly transitions: boolean;
  readonly dataFlows: FlowMode;
  /** Shows names of ports and outcomes, beside them and on transitions. */
  readonly portNames: boolean;
  readonly values: boolean;
  /** Shows unconnected outcomes *aborted* and *preempted*. */
  readonly aborted: boolean;
  readonly grid: boolean;
}

/** Colouring of states by how they ran: off, by count, or by total time. */
export type HeatMode = "off" | "count" | "time";

/** Difference of an element from its counterpart in another machine. */
type Mark = "added" | "removed" | "changed";

/** A proposed machine, drawn at its future position in the machine on display. */
export interface GhostMachine {
  /** Path of its future container. */
  readonly container: string;
  /** Its root has its position in the container. */
  readonly machine: Machine;
  /** Its state under inspection. */
  readonly chosen: string | null;
}

/** Camera of a view that has none yet, compared by identity; the canvas then fits the root. */
export const FIRST_CAMERA: Camera = { x: 0, y: 0, scale: 1 };

export interface SessionView {
  readonly camera: Signal<Camera>;
  readonly selection: Signal<ReadonlySet<ElementKey>>;
  readonly hovered: Signal<ElementRef | null>;
  readonly modes: Signal<ViewModes>;
  /** Differences of elements in a comparison; null without a comparison. */
  readonly marks: Signal<ReadonlyMap<ElementKey, Mark> | null>;
  /** Proposal of a planner; null if none. */
  readonly ghost: Signal<GhostMachine | null>;
  readonly heat: Signal<HeatMode>;
  /** Library states whose content is shown (true) or hidden (false) here, unlike in the file. */
  readonly contents: Signal<ReadonlyMap<string, boolean>>;
  /** True if the camera follows active states. */
  readonly follows: Signal<boolean>;
  /** States that are expanded in the tree; null for the root alone. */
  readonly openInTree: Signal<ReadonlySet<string> | null>;
  /** Last size of the canvas, in CSS pixels; null before the camera was first set. */
  readonly canvasSize: Signal<Size | null>;
}

export const MODES: ViewModes = {
  transitions: true,
  dataFlows: "selection",
  portNames: true,
  values: true,
  aborted: false,
  grid: false,
};

export function newView(): SessionView {
  return {
    camera: signal(FIRST_CAMERA),
    selection: signal<ReadonlySet<ElementKey>>(new Set()),
    hovered: signal<ElementRef | null>(null),
    modes: signal(MODES),
    marks: signal<ReadonlyMap<ElementKey, Mark> | null>(null),
    ghost: signal<GhostMachine | null>(null),
    heat: signal<HeatMode>("off"),
    contents: signal<ReadonlyMap<string, boolean>>(new Map()),
    follows: signal(false),
    openInTree: signal<ReadonlySet<string> | null>(null),
    canvasSize: signal<Size | null>(null),
  };
}

/** Replaces the selection. An element and a state around it are never selected together: the outer one stays. */
export function select(view: SessionView, elements: Iterable<ElementRef>): void {
  view.selection.value = withoutInner([...elements]);
}

/** Adds the element to the selection, or removes it. */
export function toggle(view: SessionView, element: ElementRef): void {
  const key = keyOf(element);
  const before = [...view.selection.value];
  const kept = before.filter(
    (other) => other !== key && !isAround(element, other) && !isInside(element, other),
  );
  view.selection.value = new Set(
    before.includes(key) ? before.filter((other) => other !== key) : [...kept, key],
  );
}

/** Selected elements in the order of their selection. */
export function selected(view: SessionView): readonly ElementRef[] {
  return [...view.selection.value].flatMap((key) => elementOf(key) ?? []);
}

/** Paths of the selected states. */
export function selectedStates(view: SessionView): readonly string[] {
  return selected(view).flatMap((element) => (element.kind === "state" ? [element.path] : []));
}

function withoutInner(elements: readonly ElementRef[]): ReadonlySet<ElementKey> {
  const states = new Set(
    elements.flatMap((element) => (element.kind === "state" ? [element.path] : [])),
  );
  const hasOuter = (element: ElementRef) => {
    let path = element.kind === "state" ? parentOf(element.path) : element.path;
    for (; path !== null; path = parentOf(path)) if (states.has(path)) return true;
    return false;
  };
  return new Set(elements.filter((element) => !hasOuter(element)).map(keyOf));
}

/** True if the element is a state that contains or owns the element of the key. */
function isAround(element: ElementRef, key: ElementKey): boolean {
  const other = elementOf(key);
  if (element.kind !== "state" || !other) return false;
  return (
    other.path.startsWith(`${element.path}/`) ||
    (other.kind !== "state" && other.path === element.path)
  );
}

function isInside(element: ElementRef, key: ElementKey): boolean {
  const other = elementOf(key);
  return other !== null && isAround(other, keyOf(element));
}
