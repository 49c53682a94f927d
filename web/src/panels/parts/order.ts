/** In which order branches are told: those that want somebody first, and else as they stand in the machine. */

import type { Phase } from "../../model/generated/protocol.ts";
import { type Active, placeOfLane } from "../../store/run/active.ts";

const URGENCY: readonly Phase[] = ["interrupted", "waiting", "held", "preempted", "running"];

export function inOrder(lanes: readonly Active[]): readonly Active[] {
  const rank = ({ phase }: Active) => URGENCY.indexOf(phase);
  return [...lanes].sort((one, other) => {
    const first = rank(one) - rank(other);
    if (first !== 0) return first;
    const [before, after] = [placeOfLane(one), placeOfLane(other)];
    return before < after ? -1 : before > after ? 1 : 0;
  });
}
