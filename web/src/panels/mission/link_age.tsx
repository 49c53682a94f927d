/** Quality of the connection, and age of the displayed data. */

import { History, Unplug, Wifi } from "lucide-react";
import type { LinkHealth } from "../../model/generated/protocol.ts";
import { isLive } from "../../model/run_words.ts";
import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import type { RunAge } from "../../store/run/age.ts";
import { silence } from "../../store/run/data_end.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useCommand, useHost } from "../context.tsx";
import { agePhrase } from "../parts/age.ts";
import { duration } from "../parts/duration.ts";
import { useRunAge } from "../run_age.ts";

export function LinkAge({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const run = useCommand();
  const age = useRunAge(page, watch);
  if (age.why === "moment") {
    return (
      <p className="mission-band mission-band-past">
        <History size={16} aria-hidden />
        <span>
          Branches and values: {duration(age.age_ms)} before the newest event. Everything else is
          live.
        </span>
        <Button onClick={() => run("run.live")}>Back to now</Button>
      </p>
    );
  }
  if (!age.isOld) return <IsHeard watch={watch} />;
  return (
    <p className="mission-band mission-band-old" role="alert">
      <Unplug size={16} aria-hidden />
      <span>{oldInWords(age)}</span>
    </p>
  );
}

/** Confirms that the displayed data is current, or shows that the robot is silent. Hidden after the end of the run. */
function IsHeard({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const pulse = useSignal(page.server.pulse);
  const phase = useComputed(() => watch.now.value?.run.phase, [watch]);
  const robot = useComputed(() => watch.now.value?.robot, [watch]);
  const silent_ms = useComputed(() => silence(page, watch, clock1s.value), [page, watch]);
  if (!isLive(phase)) return null;
  const delay = robot
    ? ` (${farAway(robot)})`
    : pulse?.delay_ms == null
      ? ""
      : ` (${Math.max(1, Math.round(pulse.delay_ms))} ms)`;
  if (silent_ms !== null) {
    return (
      <p className="mission-link">
        <Unplug size={16} aria-hidden />
        <span>Nothing received from the robot for {agePhrase(silent_ms)}</span>
      </p>
    );
  }
  return (
    <p className="mission-link">
      <Wifi size={16} aria-hidden />
      <span>
        Live<span className="mission-link-who">: server and robot respond</span>
        {delay}
      </span>
    </p>
  );
}

/** Age of the newest data from a remote robot: the delay of one direction. */
function farAway({ round_trip_ms }: LinkHealth): string {
  return round_trip_ms === null ? "delay unknown" : `${duration(round_trip_ms / 2)} ago`;
}

function oldInWords({ why, age_ms }: RunAge): string {
  if (why === "engine")
    return `The engine of the run has made no progress for ${duration(age_ms)}.`;
  if (why === "blackout")
    return `No signal from the robot: what you see is ${duration(age_ms)} old. Commands wait, and expire if they arrive too late.`;
  const who =
    why === "link" ? "No answer from the server" : "The server gets no answer from the robot";
  return `${who}: what you see is ${duration(age_ms)} old.`;
}
