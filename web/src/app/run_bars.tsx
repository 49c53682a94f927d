/** Bars on the truth of a shown run: its age and what the page does about it, missing events, an unreadable history. */

import { History, RefreshCw, Unplug } from "lucide-react";
import { agePhrase } from "../panels/parts/age.ts";
import { useRunAge } from "../panels/run_age.ts";
import { historyLag } from "../store/history/history_lag.ts";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab } from "../store/page/page.ts";
import type { RunAge } from "../store/run/age.ts";
import { useComputed, useSignal } from "../ui/signals.ts";
import { Bar } from "./bar.tsx";
import { useSession } from "./session_context.tsx";

/** Fewer arrive before a bar could be read. */
const WORTH_SAYING = 100;

export function RunBars({ tab }: { tab: OpenTab }) {
  const watch = useSignal(tab.run);
  if (!watch) return null;
  return (
    <>
      <OldBar watch={watch} />
      <CatchingUpBar watch={watch} />
      <LackBar watch={watch} />
    </>
  );
}

function OldBar({ watch }: { watch: Watch }) {
  const { page } = useSession();
  const link = useSignal(page.server.link);
  const isCurrent = useSignal(watch.isCurrent);
  const { age_ms, isOld, why } = useRunAge(page, watch);
  // A broken connection already has a bar.
  if (!isOld || (why === "link" && link.state === "down")) return null;
  return (
    <Bar kind={why === "engine" ? "danger" : "warning"} icon={<Unplug size={16} aria-hidden />}>
      {oldInWords(why, agePhrase(age_ms), isCurrent)}
    </Bar>
  );
}

function oldInWords(why: RunAge["why"], age: string, isCurrent: boolean): string {
  if (why === "engine")
    return `The run is stuck: its program responds, but its engine has made no progress for ${age}. Stop the run. If the engine does not respond, its program is ended and the run can be resumed.`;
  if (why === "silence")
    return `No answer from the run for ${age}: its program does not respond to the server. What you see is that old; the robot may be elsewhere by now.`;
  if (why === "blackout")
    return `No signal from the robot for ${age}: the link is interrupted, or the robot's computer is down. What you see is that old; the run continues on the robot as programmed.`;
  if (why === "runner")
    return `The server lost the connection to the run's program and is reconnecting. What you see of the run is ${age} old; the robot may be elsewhere by now.`;
  return isCurrent
    ? `No answer from the server for ${age}; the page is checking the connection. What you see of the run is that old.`
    : `Reconnected. The page is requesting the state of the run; what you see is ${age} old.`;
}

function CatchingUpBar({ watch }: { watch: Watch }) {
  const { page } = useSession();
  const missing = useComputed(() => {
    const isUp = page.server.link.value.state === "up";
    return isUp && !watch.isCaughtUp.value ? historyLag(watch) : 0;
  }, [page, watch]);
  if (missing < WORTH_SAYING) return null;
  return (
    <Bar icon={<RefreshCw size={16} aria-hidden />}>
      Catching up: {missing.toLocaleString("en")} events
    </Bar>
  );
}

function LackBar({ watch }: { watch: Watch }) {
  const lack = useSignal(watch.lack);
  if (lack === null) return null;
  return (
    <Bar kind="warning" icon={<History size={16} aria-hidden />}>
      The history of this run cannot be shown: {lack}
    </Bar>
  );
}
