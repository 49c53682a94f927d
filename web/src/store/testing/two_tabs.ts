/** What two tabs of a browser keep together, for tests: what one puts, the other is told of at once. */

import { type LocalStore, memoryStore } from "../local_store.ts";

export function twoTabs(): readonly [LocalStore, LocalStore] {
  const shared = memoryStore();
  const listeners: [Map<string, () => void>, Map<string, () => void>] = [new Map(), new Map()];
  const tab = (own: 0 | 1): LocalStore => ({
    get: shared.get,
    keys: shared.keys,
    put: (key, value) => {
      shared.put(key, value);
      listeners[own === 0 ? 1 : 0].get(key)?.();
    },
    whenOther: (key, told) => void listeners[own].set(key, told),
  });
  return [tab(0), tab(1)];
}
