/** True if an element has kept its position long enough for a press to be intentional. Buttons that moved under a finger wait for it. */

import { SLIP_MS } from "./confirm_press.ts";
import { useDebounced } from "./debounced.ts";

/** `key` is another text whenever something came, went or moved. */
export function useStableFor(key: string): boolean {
  return useDebounced(key, SLIP_MS) === key;
}
