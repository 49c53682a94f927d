/** What two tabs of a browser keep together, for tests: what one puts, the other is told of at once. */

import { memoryShed, type Shed } from "../shed.ts";

export function twoTabs(): readonly [Shed, Shed] {
  const shared = memoryShed();
  const listeners: [Map<string, () => void>, Map<string, () => void>] = [new Map(), new Map()];
  const tab = (own: 0 | 1): Shed => ({
    get: shared.get,
    put: (key, value) => {
      shared.put(key, value);
      listeners[own === 0 ? 1 : 0].get(key)?.();
    },
    whenOther: (key, told) => void listeners[own].set(key, told),
  });
  return [tab(0), tab(1)];
}
