/** The wait for a planned contact with a robot. */

import type { LinkHealth } from "./generated/protocol.ts";

/** As in the protocol: two clocks drift apart by 1 ms in 5 s, and the link shortens a lifetime by an equal amount. */
const DRIFT_PART = 2_500;

/** Time until a command can be sent: until the next planned contact if none is open, else 0. */
export function untilContact_ms({ contact }: LinkHealth, server_ms: number): number {
  return contact === undefined ? 0 : Math.max(0, contact.begin_ms - server_ms);
}

/** The part of a lifetime until the next contact, including the drift of the clocks. */
export function waitForContact_ms(link: LinkHealth, server_ms: number): number {
  const wait_ms = untilContact_ms(link, server_ms);
  return wait_ms + Math.floor(wait_ms / DRIFT_PART);
}
