/** Reason of a refusal, shown beside the field. */

import { useCallback, useState } from "react";

import type { Made } from "../../store/page/apply_plan.ts";

/** Last refusal, and a function that runs an edit and stores its refusal. */
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
