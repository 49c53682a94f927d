/** A value that follows its source after a pause without changes, for expensive computations. */

import { useEffect, useState } from "react";

export function useDebounced<T>(value: T, patience_ms: number): T {
  const [settled, setSettled] = useState(value);
  useEffect(() => {
    const timer = setTimeout(() => setSettled(value), patience_ms);
    return () => clearTimeout(timer);
  }, [value, patience_ms]);
  return settled;
}
