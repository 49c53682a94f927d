/** Values of global variables in the run, live or at the shown moment. */

import { useEffect } from "react";
import type { Watch } from "../../store/history/run.ts";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { ValueView } from "../parts/value/value_view.tsx";

interface GlobalsInRunProps {
  readonly watch: Watch;
  /** Text in the panel's filter. */
  readonly query: string;
}

export function InRun({ watch, query }: GlobalsInRunProps) {
  useEffect(() => watch.wantValues(), [watch]);
  const snapshot = useSignal(watch.playheadSnapshot);
  const playhead = useSignal(watch.playhead);
  const wanted = query.trim().toLowerCase();
  const all = Object.entries(snapshot?.picture.globals ?? {})
    .filter(([name]) => name.toLowerCase().includes(wanted))
    .sort(([one], [other]) => one.localeCompare(other));
  const isOnItsWay =
    snapshot === null || (playhead !== null && snapshot.picture.sequence !== playhead);
  return (
    <Section
      title={playhead === null ? "In the run" : `In the run, at event ${playhead}`}
      count={all.length}
    >
      <div className="globals-run shows-run" aria-busy={isOnItsWay}>
        {all.map(([name, value]) => (
          <ValueView key={name} name={name} value={value} keep={`global ${name}`} />
        ))}
        {all.length === 0 && (
          <p className="globals-soft">
            {isOnItsWay ? "Loading values…" : "No global variable had a value at this moment."}
          </p>
        )}
      </div>
    </Section>
  );
}
