/** A throttled signal: the first change passes immediately, later ones at an interval, and the last one always. */

import type { ReadonlySignal } from "@preact/signals-core";
import { useEffect, useState } from "react";

export function useThrottled<T>(signal: ReadonlySignal<T>, pace_ms: number): T {
  const [value, setValue] = useState(() => signal.peek());
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    let updated_ms = Number.NEGATIVE_INFINITY;
    const tell = () => {
      timer = undefined;
      updated_ms = performance.now();
      setValue(() => signal.peek());
    };
    const stop = signal.subscribe(() => {
      if (timer !== undefined) return;
      const wait_ms = updated_ms + pace_ms - performance.now();
      if (wait_ms <= 0) tell();
      else timer = setTimeout(tell, wait_ms);
    });
    return () => {
      stop();
      clearTimeout(timer);
    };
  }, [signal, pace_ms]);
  return value;
}
