/** Why what was just asked for was refused, at its place. */

import { useCallback, useState } from "react";
import type { Made } from "./inspector_context.ts";

/** The last refusal, and the way to wait for what may be refused. */
export function useRefusal(): readonly [string | null, (made: Made) => void] {
  const [refusal, setRefusal] = useState<string | null>(null);
  const run = useCallback((made: Made) => {
    setRefusal(null);
    Promise.resolve(made).then(setRefusal, (error) => setRefusal(String(error)));
  }, []);
  return [refusal, run];
}

export function Refusal({ text }: { text: string | null }) {
  return text === null ? null : (
    <p className="inspector-refusal" role="alert">
      {text}
    </p>
  );
}
