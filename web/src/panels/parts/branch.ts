/** Active branches in a list: order, icon and text of each phase, and the style of the previous end. */

import {
  CirclePause,
  CirclePlay,
  Hourglass,
  type LucideIcon,
  OctagonAlert,
  Undo2,
} from "lucide-react";
import type { Outcome, Phase } from "../../model/generated/protocol.ts";
import { ABORTED, PREEMPTED } from "../../model/machine.ts";
import { type Active, placeOfLane } from "../../store/run/active.ts";

const URGENCY: readonly Phase[] = ["interrupted", "waiting", "held", "preempted", "running"];

/** Branches that need a person first, otherwise in the order of the machine. */
export function inOrder(lanes: readonly Active[]): readonly Active[] {
  const rank = ({ phase }: Active) => URGENCY.indexOf(phase);
  return [...lanes].sort((one, other) => {
    const first = rank(one) - rank(other);
    if (first !== 0) return first;
    const [before, after] = [placeOfLane(one), placeOfLane(other)];
    return before < after ? -1 : before > after ? 1 : 0;
  });
}

export const PHASES: Readonly<Record<Phase, { readonly word: string; readonly Icon: LucideIcon }>> =
  {
    running: { word: "runs", Icon: CirclePlay },
    waiting: { word: "waits", Icon: Hourglass },
    held: { word: "paused", Icon: CirclePause },
    interrupted: { word: "interrupted by a crash", Icon: OctagonAlert },
    preempted: { word: "is being preempted", Icon: Undo2 },
  };

/** Text of the phase; `held` returns the text of a paused branch. */
export function phaseInWords(
  { phase, detail, held: [hold] }: Active,
  held: (by: Active["held"][number]["by"], isBefore: boolean) => string,
): string {
  if (phase === "waiting" && detail) return `waits for ${detail}`;
  if (phase === "held" && hold) return held(hold.by, hold.next !== null);
  return PHASES[phase].word;
}

/** True if the state has not been entered yet. The durations of the states around it are irrelevant then. */
export function comesNext({ phase, held: [hold] }: Active): boolean {
  return phase === "held" && hold?.next != null;
}

/** Suffix of the class name for an outcome; empty if the state succeeded. */
export function toneOf({ id }: Outcome): "aborted" | "preempted" | "" {
  if (id === ABORTED) return "aborted";
  return id === PREEMPTED ? "preempted" : "";
}
