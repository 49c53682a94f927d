/** Why what was just asked for was refused, at its place. */

import { useCallback, useState } from "react";

/** The last refusal, and the way to wait for what may be refused. */
export function useRefusal(): readonly [string | null, (made: Promise<string | null>) => void] {
  const [refusal, setRefusal] = useState<string | null>(null);
  const run = useCallback((made: Promise<string | null>) => {
    setRefusal(null);
    made.then(setRefusal, (error) => setRefusal(String(error)));
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
