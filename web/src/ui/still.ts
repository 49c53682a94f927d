/** Whether what a press would meet has stood where it is for so long that the press can be meant for it. Buttons that moved under a
 * finger wait for it. */

import { useSettled } from "./settled.ts";
import { SLIP_MS } from "./twice.ts";

/** `key` is another text whenever something came, went or moved. */
export function useStill(key: string): boolean {
  return useSettled(key, SLIP_MS) === key;
}
