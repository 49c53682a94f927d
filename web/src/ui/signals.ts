/** Signals in components: a component that reads one by this hook is drawn again when it changes. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import { useCallback, useMemo, useSyncExternalStore } from "react";

export function useSignal<T>(signal: ReadonlySignal<T>): T {
  const subscribe = useCallback((changed: () => void) => signal.subscribe(changed), [signal]);
  return useSyncExternalStore(subscribe, () => signal.peek());
}

/** Value of a function of signals; the component renders again when it changes. `deps` are its other dependencies. */
export function useComputed<T>(
  read: () => T,
  deps: readonly unknown[],
  isEqual: (one: T, other: T) => boolean = Object.is,
): T {
  // biome-ignore lint/correctness/useExhaustiveDependencies: passed by the caller
  return useSignal(useMemo(() => computedWith(read, isEqual), deps));
}

/** A computed signal that keeps its object while new values equal it. */
export function computedWith<T>(
  read: () => T,
  isEqual: (one: T, other: T) => boolean,
): ReadonlySignal<T> {
  let last: { readonly value: T } | null = null;
  return computed(() => {
    const value = read();
    if (!last || !isEqual(last.value, value)) last = { value };
    return last.value;
  });
}

/** True if two lists are equal. */
export function isSameList<T>(
  one: readonly T[] | null,
  other: readonly T[] | null,
  isEqual: (one: T, other: T) => boolean = Object.is,
): boolean {
  if (one === null || other === null || one === other) return one === other;
  return (
    one.length === other.length && one.every((member, place) => isEqual(member, other[place] as T))
  );
}

/** True if two plain objects are equal. */
export function isSameRecord<T extends object>(one: T | null, other: T | null): boolean {
  if (one === null || other === null) return one === other;
  return isSameList(Object.entries(one).flat(), Object.entries(other).flat());
}
