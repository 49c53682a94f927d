/** Signals in components: a component that reads one by this hook is drawn again when it changes. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import { useCallback, useMemo, useSyncExternalStore } from "react";

export function useSignal<T>(signal: ReadonlySignal<T>): T {
  const subscribe = useCallback((changed: () => void) => signal.subscribe(changed), [signal]);
  return useSyncExternalStore(subscribe, () => signal.peek());
}

/** What a function of signals gives, drawn again when that is another value; `deps` are what else it depends on. */
export function useComputed<T>(read: () => T, deps: readonly unknown[]): T {
  // biome-ignore lint/correctness/useExhaustiveDependencies: the caller says them
  return useSignal(useMemo(() => computed(read), deps));
}
