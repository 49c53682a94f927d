/** Input of a picture. */

import type { ElementKey, ElementRef } from "../../model/element.ts";
import type { Severity } from "../../model/generated/protocol.ts";
import type { Size } from "../../model/geometry.ts";
import type { Camera, ViewModes } from "../../store/page/view.ts";
import type { LineMarkOfRun, RunMark } from "../../store/run/marks.ts";
import type { LayoutTree } from "../layout/layout_tree.ts";
import type { Overlay } from "../overlay.ts";

/** Kind of difference between a part and the machine that it is compared with. */
export type DifferenceKind = "added" | "removed" | "changed";

/** Value at a port. */
export interface ValueChip {
  /** Abbreviated value. */
  readonly short: string;
  /** Full value, cut only at the limit of what can be shown. */
  readonly full: string;
}

/** Heat of states from 0 to `HEAT_LEVELS`, by path. */
export type Heat = ReadonlyMap<string, number>;

/** Number of shades of heat. */
export const HEAT_LEVELS = 5;

/** Another user who has the machine open. */
export interface Onlooker {
  readonly name: string;
  /** Index of the user's colour. */
  readonly colour: number;
  /** Paths of the states that the user has selected. */
  readonly selection: readonly string[];
}

/** Measures the width of a text, in CSS pixels. */
export type Measure = (text: string, size: number, bold: boolean) => number;

export interface SceneInput {
  readonly layout: LayoutTree;
  readonly camera: Camera;
  /** Size of the view, in CSS pixels. */
  readonly view: Size;
  readonly modes: ViewModes;
  readonly selection: ReadonlySet<ElementKey>;
  readonly hovered: ElementRef | null;
  readonly overlay: Overlay;
  readonly people: readonly Onlooker[];
  /** Most severe problem of each state. */
  readonly problems: ReadonlyMap<string, Severity>;
  readonly differences: ReadonlyMap<ElementKey, DifferenceKind>;
  /** Results of a search. */
  readonly hits: ReadonlySet<ElementKey>;
  /** Activity of states in the run. */
  readonly runs: ReadonlyMap<string, RunMark>;
  /** Errors of failed states, shown while a state is hovered. */
  readonly errors: ReadonlyMap<string, string>;
  /** Transitions that were taken recently or come next. */
  readonly taken: ReadonlyMap<ElementKey, LineMarkOfRun>;
  /** Time since the snapshot of the marks, in ms. */
  readonly sinceSnapshot_ms: number;
  /** Number of times that a state was entered. */
  readonly visits: (path: string) => number;
  readonly values: ReadonlyMap<ElementKey, ValueChip>;
  /** Null while heat is hidden. */
  readonly heat: Heat | null;
  /** States with breakpoints: "on" if any breakpoint of the state is enabled. */
  readonly breakpoints: ReadonlyMap<string, "on" | "off">;
  readonly measure: Measure;
  /** True if time is left to route the lines of another container. */
  readonly mayRoute: () => boolean;
}

/** Input without selection, run or other highlights. */
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
