/** Whether what a press would meet has stood where it is for so long that the press can be meant for it. Buttons that moved under a
 * finger wait for it. */

import { SLIP_MS } from "./confirm_press.ts";
import { useDebounced } from "./debounced.ts";

/** `key` is another text whenever something came, went or moved. */
export function useStableFor(key: string): boolean {
  return useDebounced(key, SLIP_MS) === key;
}
