/** Age of a value that arrived ahead of its event, by the robot's clock. */

import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { runTimes } from "../../store/page/times.ts";
import { assumedElapsed } from "../../store/run/data_end.ts";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { duration } from "../parts/duration.ts";

const WHY = "The robot sent this value ahead: older events are still to come, then its own.";

export function Ahead({ watch, at_ns }: { readonly watch: Watch; readonly at_ns: number }) {
  const { page } = useHost().context();
  const here_ms = useSignal(clock1s);
  const now_ms = useComputed(() => assumedElapsed(page, watch, here_ms), [page, watch, here_ms]);
  // Data from the robot is as old as the delay of one direction.
  const way_ms = useComputed(() => (watch.now.value?.robot?.round_trip_ms ?? 0) / 2, [watch]);
  const age_ms = Math.max(0, now_ms + way_ms - at_ns / 1e6);
  return (
    <span className="watches-when watches-ahead" title={`${WHY}\n${runTimes(watch, at_ns)}`}>
      {duration(age_ms)} old, ahead of history
    </span>
  );
}
