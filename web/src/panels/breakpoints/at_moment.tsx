/** Breakpoints of the run at an earlier moment. They are read-only. */

import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { namesOf } from "../parts/happened.ts";
import { breakpointInWords } from "./words.ts";

interface AtMomentProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
}

export function AtMoment({ tab, watch }: AtMomentProps) {
  const playhead = useSignal(watch.playhead);
  const snapshot = useSignal(watch.playheadSnapshot);
  if (playhead === null) return null;
  const isHere = snapshot?.picture.sequence === playhead;
  const all = isHere ? snapshot.picture.breakpoints : [];
  const nameOf = namesOf(tab.session);
  return (
    <Section title={`At event ${playhead}`} count={isHere ? all.length : undefined}>
      {!isHere && <p className="breakpoints-whose">Loading…</p>}
      {isHere && all.length === 0 && (
        <p className="breakpoints-whose">No breakpoints at this moment.</p>
      )}
      <ul className="breakpoints-then">
        {all.map((breakpoint) => (
          <li key={breakpoint.id}>
            <strong>{nameOf(breakpoint.path)}</strong> {breakpointInWords(breakpoint)}
            {!breakpoint.enabled && " (off)"}
          </li>
        ))}
      </ul>
    </Section>
  );
}
