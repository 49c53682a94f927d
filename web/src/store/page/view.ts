/** How one open machine is looked at: what is selected, where the camera is, which layers show. Belongs to this page only. */

import { type Signal, signal } from "@preact/signals-core";
import { type ElementKey, type ElementRef, elementOf, keyOf } from "../../model/element.ts";
import type { Size } from "../../model/geometry.ts";
import type { Machine } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";

/** What the screen shows: `scale` CSS pixels for one unit of the root, and the root's coordinates in the screen's left top corner. */
export interface Camera {
  readonly x: number;
  readonly y: number;
  readonly scale: number;
}

export type FlowMode = "all" | "selection" | "none";

export interface ViewModes {
  readonly transitions: boolean;
  readonly dataFlows: FlowMode;
  /** Names of ports and outcomes, beside them and on transitions. */
  readonly portNames: boolean;
  readonly values: boolean;
  /** Whether aborted and preempted show where nothing is connected to them. */
  readonly aborted: boolean;
  readonly grid: boolean;
}

/** What colours states by how they ran: nothing, how often, or how long altogether. */
export type HeatMode = "off" | "count" | "time";

/** How an element differs from its counterpart in another machine. */
type Mark = "added" | "removed" | "changed";

/** A machine that is offered and not part of the one that is shown: drawn where it would stand. */
export interface GhostMachine {
  /** The container that it would stand in. */
  readonly container: string;
  /** Its root has the place in the container. */
  readonly machine: Machine;
  /** Of its states, the one that is looked at. */
  readonly chosen: string | null;
}

/** Where a view looks before anybody has chosen: the canvas fits the root then. */
export const FIRST_CAMERA: Camera = { x: 0, y: 0, scale: 1 };

export interface SessionView {
  readonly camera: Signal<Camera>;
  readonly selection: Signal<ReadonlySet<ElementKey>>;
  readonly hovered: Signal<ElementRef | null>;
  readonly modes: Signal<ViewModes>;
  /** How elements differ from what the machine is compared with; null if it is compared with nothing. */
  readonly marks: Signal<ReadonlyMap<ElementKey, Mark> | null>;
  /** What a planner offers; null if nothing is. */
  readonly ghost: Signal<GhostMachine | null>;
  /** What of the run colours states. */
  readonly heat: Signal<HeatMode>;
  /** Library states whose content is shown or hidden here, other than the file says. */
  readonly contents: Signal<ReadonlyMap<string, boolean>>;
  /** Whether the camera follows what runs. */
  readonly follows: Signal<boolean>;
  /** The states that are open in the tree; null: the root alone. */
  readonly openInTree: Signal<ReadonlySet<string> | null>;
  /** How large the canvas was last, in CSS pixels; null before the camera was set once. */
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

/** Selects these and nothing else. An element and a state around it are never selected together: the outer one stays. */
export function select(view: SessionView, elements: Iterable<ElementRef>): void {
  view.selection.value = withoutInner([...elements]);
}

/** Adds the element to the selection, or takes it out. */
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

/** The selected elements in the order in which they were selected. */
export function selected(view: SessionView): readonly ElementRef[] {
  return [...view.selection.value].flatMap((key) => elementOf(key) ?? []);
}

/** The paths of the selected states. */
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

/** Whether the element is a state around, or owning, what the key is of. */
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
