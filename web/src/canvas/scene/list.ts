/** What is to be painted: marks in CSS pixels of the view, layer upon layer. Inks are names; which colours they are only
 * `paint` knows. */

import type { LayoutNode } from "../layout_node.ts";

/** A name of a colour, `shade0` … by depth, or a colour as CSS writes it. */
export type Ink = string;

export interface BoxMark {
  readonly what: string;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  readonly radius: number;
  readonly fill: Ink | null;
  readonly stroke: Ink | null;
  readonly line: number;
  readonly dash: boolean;
  readonly alpha: number;
}

export interface LineMark {
  readonly what: string;
  /** x and y in turn. */
  readonly points: readonly number[];
  readonly ink: Ink;
  readonly width: number;
  /** How round the corners are. */
  readonly radius: number;
  /** Whether the points are those of a curve. */
  readonly curve: boolean;
  /** How long the head of the arrow at the end is; 0: none. */
  readonly arrow: number;
  readonly dash: boolean;
  readonly alpha: number;
}

export type DotShape =
  | "income"
  | "outcome"
  | "data"
  | "scoped"
  | "waypoint"
  | "handle"
  | "start"
  | "breakpoint";

export interface DotMark {
  readonly what: string;
  readonly shape: DotShape;
  readonly x: number;
  readonly y: number;
  readonly size: number;
  /** Where it points to. */
  readonly toX: number;
  readonly toY: number;
  readonly fill: Ink | null;
  readonly stroke: Ink | null;
  readonly alpha: number;
}

export interface TextMark {
  readonly what: string;
  readonly x: number;
  /** Of the middle of the text's height. */
  readonly y: number;
  readonly text: string;
  readonly size: number;
  readonly bold: boolean;
  readonly ink: Ink;
  readonly align: "left" | "center" | "right";
  readonly alpha: number;
  /** A plate behind it. */
  readonly plate: Ink | null;
  /** How wide the text is; 0: not measured. */
  readonly width: number;
  /** So much wider is the plate to the left. */
  readonly lead?: number;
}

export type Icon =
  | "library"
  | "missing"
  | "barrier"
  | "preemptive"
  | "decider"
  | "error"
  | "warning"
  | "start"
  | "running"
  | "waiting"
  | "held"
  | "next"
  | "failed"
  | "preempted"
  | "added"
  | "removed"
  | "changed";

export interface IconMark {
  readonly what: string;
  readonly icon: Icon;
  /** Of its middle. */
  readonly x: number;
  readonly y: number;
  readonly size: number;
  readonly ink: Ink;
  readonly alpha: number;
}

/** Marks that are painted kind after kind, in this order. */
export interface Layer {
  readonly under: LineMark[];
  readonly specks: BoxMark[];
  readonly boxes: BoxMark[];
  readonly lines: LineMark[];
  readonly dots: DotMark[];
  readonly icons: IconMark[];
  readonly texts: TextMark[];
}

export interface DrawList {
  readonly layers: readonly Layer[];
  /** Library states whose content would show, were it here. */
  readonly wanted: readonly string[];
  /** Containers whose lines are not found yet, and will be needed with the next steps inwards. */
  readonly soon: readonly LayoutNode[];
  /** Whether something is missing that another frame will bring. */
  readonly unfinished: boolean;
}

export function newLayer(): Layer {
  return { under: [], specks: [], boxes: [], lines: [], dots: [], icons: [], texts: [] };
}
