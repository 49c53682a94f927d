/** Draw list: marks in CSS pixels of the view, layer by layer. Inks are names; only `paint` maps them to colours. */

import type { LayoutNode } from "../layout/layout_node.ts";

/** Name of a colour, a shade by depth such as `shade0`, or a CSS colour. */
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
  /** Alternating x and y. */
  readonly points: readonly number[];
  readonly ink: Ink;
  readonly width: number;
  /** Radius of the corners. */
  readonly radius: number;
  /** True if the points are those of a curve. */
  readonly curve: boolean;
  /** Length of the arrow head at the end; 0 for none. */
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
  /** Direction in which the dot points. */
  readonly toX: number;
  readonly toY: number;
  readonly fill: Ink | null;
  readonly stroke: Ink | null;
  readonly alpha: number;
}

export interface TextMark {
  readonly what: string;
  readonly x: number;
  /** Vertical centre of the text. */
  readonly y: number;
  readonly text: string;
  readonly size: number;
  readonly bold: boolean;
  readonly ink: Ink;
  readonly align: "left" | "center" | "right";
  readonly alpha: number;
  /** Colour of the plate behind the text; null for no plate. */
  readonly plate: Ink | null;
  /** Width of the text; 0 if not measured. */
  readonly width: number;
  /** Additional width of the plate on the left. */
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
  /** Centre of the icon. */
  readonly x: number;
  readonly y: number;
  readonly size: number;
  readonly ink: Ink;
  readonly alpha: number;
}

/** Marks that are painted in this order, one kind after another. */
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
  /** Library states with visible but missing content. */
  readonly wanted: readonly string[];
  /** Containers with unrouted lines that will be visible after the next zoom step. */
  readonly soon: readonly LayoutNode[];
  /** True if something is missing that another frame will add. */
  readonly unfinished: boolean;
}

export function newLayer(): Layer {
  return { under: [], specks: [], boxes: [], lines: [], dots: [], icons: [], texts: [] };
}
