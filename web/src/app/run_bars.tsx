/** What has to be known about the truth of what is shown of a run: how old it may be and what is done about it, whether the page
 * still catches up, whether the history cannot be told. */

import { History, RefreshCw, Unplug } from "lucide-react";
import { useRunAge } from "../panels/run_age.ts";
import type { RunAge } from "../store/age.ts";
import { historyLag } from "../store/history_lag.ts";
import type { OpenTab } from "../store/page.ts";
import type { Watch } from "../store/run.ts";
import { useSignal } from "../ui/signals.ts";
import { agePhrase } from "./age.ts";
import { Bar } from "./bar.tsx";
import { useDerived, useSession } from "./provided.tsx";

/** Fewer are told before anybody could read that they are. */
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
  // Of a broken connection there is a bar already.
  if (!isOld || (why === "link" && link.state === "down")) return null;
  return (
    <Bar kind={why === "engine" ? "danger" : "warning"} icon={<Unplug size={16} aria-hidden />}>
      {oldInWords(why, agePhrase(age_ms), isCurrent)}
    </Bar>
  );
}

function oldInWords(why: RunAge["why"], age: string, isCurrent: boolean): string {
  if (why === "engine")
    return `The run stands still: its program answers, but its engine has not moved for ${age}. Stop it; if the engine does not take the stop, the program is ended, and the run can be taken up.`;
  if (why === "silence")
    return `The run has not been heard of for ${age}: its program does not answer the server. What is shown is as old; the robot may be elsewhere.`;
  if (why === "runner")
    return `The server has lost the program that runs the machine, and looks for it. What is shown of the run is ${age} old; the robot may be elsewhere.`;
  return isCurrent
    ? `The server was not heard for ${age}, and is asked whether it is there. What is shown of the run is as old.`
    : `The connection is back, and the server is asked how the run stands. What is shown of it is ${age} old.`;
}

function CatchingUpBar({ watch }: { watch: Watch }) {
  const { page } = useSession();
  const missing = useDerived(() => {
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
