/** Storage shared by two tabs of a browser, for tests. Each tab is notified immediately of the other's changes. */

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
    whenOther: (key, listener) => void listeners[own].set(key, listener),
  });
  return [tab(0), tab(1)];
}
