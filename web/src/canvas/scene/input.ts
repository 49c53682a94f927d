/** All that a picture is made from. */

import type { ElementKey, ElementRef } from "../../model/element.ts";
import type { Severity } from "../../model/generated/protocol.ts";
import type { Size } from "../../model/geometry.ts";
import type { Camera, ViewModes } from "../../store/view.ts";
import type { Overlay } from "../overlay.ts";
import type { Placed } from "../placed.ts";

/** How a part differs from the machine that it is compared with. */
export type Difference = "added" | "removed" | "changed";

/** What a state does in a run. */
export interface RunMark {
  readonly phase: "running" | "waiting" | "held" | "failed" | "preempted" | "trail";
}

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
  readonly placed: Placed;
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
  readonly differences: ReadonlyMap<ElementKey, Difference>;
  /** What a search has found. */
  readonly hits: ReadonlySet<ElementKey>;
  readonly runs: ReadonlyMap<string, RunMark>;
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
  differences: new Map<ElementKey, Difference>(),
  hits: new Set<ElementKey>(),
  runs: new Map<string, RunMark>(),
  mayRoute: () => true,
} as const;
