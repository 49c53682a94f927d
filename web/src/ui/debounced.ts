/** A value that is followed once it has stayed the same for a while: for what is dear to work out and in no hurry. */

import { useEffect, useState } from "react";

export function useDebounced<T>(value: T, patience_ms: number): T {
  const [settled, setSettled] = useState(value);
  useEffect(() => {
    const timer = setTimeout(() => setSettled(value), patience_ms);
    return () => clearTimeout(timer);
  }, [value, patience_ms]);
  return settled;
}
