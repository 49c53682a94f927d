/** Signals in components: a component that reads one by this hook is drawn again when it changes. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import { useCallback, useMemo, useSyncExternalStore } from "react";

export function useSignal<T>(signal: ReadonlySignal<T>): T {
  const subscribe = useCallback((changed: () => void) => signal.subscribe(changed), [signal]);
  return useSyncExternalStore(subscribe, () => signal.peek());
}

/** What a function of signals gives, drawn again when that is another value; `deps` are what else it depends on. */
export function useComputed<T>(
  read: () => T,
  deps: readonly unknown[],
  isEqual: (one: T, other: T) => boolean = Object.is,
): T {
  // biome-ignore lint/correctness/useExhaustiveDependencies: the caller says them
  return useSignal(useMemo(() => computedWith(read, isEqual), deps));
}

/** A computed signal that keeps its value, the same object, as long as a new one would equal it. */
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

/** Whether two lists have the same members in the same order. */
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

/** Whether two plain objects have the same members. */
export function isSameRecord<T extends object>(one: T | null, other: T | null): boolean {
  if (one === null || other === null) return one === other;
  return isSameList(Object.entries(one).flat(), Object.entries(other).flat());
}
