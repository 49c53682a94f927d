/** All that a picture is made from. */

import type { ElementKey, ElementRef } from "../../model/element.ts";
import type { Severity } from "../../model/generated/protocol.ts";
import type { Size } from "../../model/geometry.ts";
import type { Camera, ViewModes } from "../../store/page/view.ts";
import type { LineMarkOfRun, RunMark } from "../../store/run/marks.ts";
import type { LayoutTree } from "../layout_tree.ts";
import type { Overlay } from "../overlay.ts";

/** How a part differs from the machine that it is compared with. */
export type DifferenceKind = "added" | "removed" | "changed";

/** A value at a port. */
export interface ValueChip {
  /** In a few letters. */
  readonly short: string;
  /** As much of it as can be shown at all. */
  readonly full: string;
}

/** How hot states are, from 0 to `HEAT_LEVELS`, by path. */
export type Heat = ReadonlyMap<string, number>;

/** So many shades of heat there are. */
export const HEAT_LEVELS = 5;

/** Somebody else who looks at the machine. */
export interface Onlooker {
  readonly name: string;
  /** Which of the colours of people is theirs. */
  readonly colour: number;
  /** Paths of the states that they have selected. */
  readonly selection: readonly string[];
}

/** How wide a text is, in CSS pixels. */
export type Measure = (text: string, size: number, bold: boolean) => number;

export interface SceneInput {
  readonly layout: LayoutTree;
  readonly camera: Camera;
  /** Of the view, in CSS pixels. */
  readonly view: Size;
  readonly modes: ViewModes;
  readonly selection: ReadonlySet<ElementKey>;
  readonly hovered: ElementRef | null;
  readonly overlay: Overlay;
  readonly people: readonly Onlooker[];
  /** The worst that is wrong with each state. */
  readonly problems: ReadonlyMap<string, Severity>;
  readonly differences: ReadonlyMap<ElementKey, DifferenceKind>;
  /** What a search has found. */
  readonly hits: ReadonlySet<ElementKey>;
  /** What states do in the run. */
  readonly runs: ReadonlyMap<string, RunMark>;
  /** Errors of the states that failed, which show while one points at them. */
  readonly errors: ReadonlyMap<string, string>;
  /** Transitions that were taken lately or come next. */
  readonly taken: ReadonlyMap<ElementKey, LineMarkOfRun>;
  /** How much later it is than the marks were said, in ms. */
  readonly sinceSnapshot_ms: number;
  /** How often a state was entered. */
  readonly visits: (path: string) => number;
  /** Values at ports. */
  readonly values: ReadonlyMap<ElementKey, ValueChip>;
  /** Null while it is not shown. */
  readonly heat: Heat | null;
  /** States with breakpoints: whether any of theirs is on. */
  readonly breakpoints: ReadonlyMap<string, "on" | "off">;
  readonly measure: Measure;
  /** Whether there is time left to find the ways of another container's lines. */
  readonly mayRoute: () => boolean;
}

/** Nothing special about anything. */
export const PLAIN = {
  selection: new Set<ElementKey>(),
  hovered: null,
  people: [],
  problems: new Map<string, Severity>(),
  differences: new Map<ElementKey, DifferenceKind>(),
  hits: new Set<ElementKey>(),
  runs: new Map<string, RunMark>(),
  errors: new Map<string, string>(),
  taken: new Map<ElementKey, LineMarkOfRun>(),
  sinceSnapshot_ms: 0,
  visits: (_path: string) => 0,
  values: new Map<ElementKey, ValueChip>(),
  heat: null,
  breakpoints: new Map<string, "on" | "off">(),
  mayRoute: () => true,
} as const;
