/** Texts about breakpoints. */

import type { Breakpoint, Unattended } from "../../model/generated/protocol.ts";

const ALONE: Readonly<Record<Unattended, string>> = {
  hold: "",
  continue: "continues while nobody is connected",
  stop: "stops the run while nobody is connected",
};

function alone({ unattended, lost_link_ms }: Breakpoint): string {
  if (unattended === "hold" || lost_link_ms == null) return ALONE[unattended];
  return `${ALONE[unattended]} or the ground is silent for ${lost_link_ms / 1000} s`;
}

/** Such as `before, from the 3rd time on, pauses the whole run`. */
export function breakpointInWords(breakpoint: Breakpoint): string {
  const { when, hit_count, scope } = breakpoint;
  const parts = [
    when,
    hit_count > 1 ? `from the ${ordinal(hit_count)} time on` : "",
    scope === "run" ? "pauses the whole run" : "",
    alone(breakpoint),
  ];
  return parts.filter((part) => part !== "").join(", ");
}

function ordinal(count: number): string {
  const last = count % 10;
  const isTeen = Math.floor(count / 10) % 10 === 1;
  const ending = isTeen ? "th" : ({ 1: "st", 2: "nd", 3: "rd" }[last] ?? "th");
  return `${count}${ending}`;
}
