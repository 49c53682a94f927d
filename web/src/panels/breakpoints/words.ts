/** A breakpoint in words. */

import type { Breakpoint, Unattended } from "../../model/generated/protocol.ts";

const ALONE: Readonly<Record<Unattended, string>> = {
  hold: "",
  continue: "continues while nobody is connected",
  stop: "stops the run while nobody is connected",
};

/** `before, from the 3rd time on, pauses the whole run`. */
export function breakpointInWords({ when, hit_count, scope, unattended }: Breakpoint): string {
  const parts = [
    when,
    hit_count > 1 ? `from the ${ordinal(hit_count)} time on` : "",
    scope === "run" ? "pauses the whole run" : "",
    ALONE[unattended],
  ];
  return parts.filter((part) => part !== "").join(", ");
}

function ordinal(count: number): string {
  const last = count % 10;
  const isTeen = Math.floor(count / 10) % 10 === 1;
  const ending = isTeen ? "th" : ({ 1: "st", 2: "nd", 3: "rd" }[last] ?? "th");
  return `${count}${ending}`;
}
