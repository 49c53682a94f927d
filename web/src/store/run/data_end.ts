/** The end of a run's data: the time until which the page knows the run. All clocks, durations and alarms of a run stop there while
 * nothing arrives. Knows the health of both links, server to page and program or robot to server; never this browser's clock. */

import type { RunNow } from "../../model/generated/protocol.ts";
import type { Watch } from "../history/run.ts";
import type { Page } from "../page/page.ts";

type LinkedPage = { readonly server: Pick<Page["server"], "pulse"> };
type Confirmed = Pick<Watch, "now" | "proven_ms" | "isCurrent">;

/** Interval in which a server asks its programs and stations about their links, with some margin, in ms. */
const SERVER_ASKS_MS = 2_000;

/** End of the data, by the server's clock. Null before the first status. Reads signals. */
export function dataEnd(page: LinkedPage, watch: Confirmed): number | null {
  const server_ms = confirmedByServer(page, watch);
  const now = watch.now.value;
  return server_ms === null || now === null ? null : Math.min(server_ms, programHeard(now));
}

/** Time from the end of the data to the present. Reads signals. */
export function sinceDataEnd(page: LinkedPage, watch: Confirmed, now_ms: number): number {
  return sinceServerTime(page, dataEnd(page, watch), now_ms);
}

/** True if the server has confirmed nothing for longer than the network explains. Reads signals. */
export function isServerSilent(page: LinkedPage, watch: Confirmed, now_ms: number): boolean {
  const silent_ms = sinceServerTime(page, confirmedByServer(page, watch), now_ms);
  return silent_ms >= (page.server.pulse.value?.old_ms ?? 0);
}

/** Length of a silence of the robot that is longer than its usual interval; null while there is none. The station reports a cut only
 * once it is certain. Reads signals. */
export function silence(page: LinkedPage, watch: Confirmed, now_ms: number): number | null {
  const robot = watch.now.value?.robot;
  if (!robot) return null;
  const silent_ms = sinceDataEnd(page, watch, now_ms);
  return silent_ms > robot.expected_every_ms + SERVER_ASKS_MS ? silent_ms : null;
}

/** Elapsed time of the run at the end of its data, in ms. For a run that is over, its length. Reads signals. */
export function elapsedAtDataEnd(page: LinkedPage, watch: Confirmed): number {
  const now = watch.now.value;
  if (!now) return 0;
  if (now.run.phase !== "live" || !now.snapshot) return now.run.length_ms;
  return now.snapshot.elapsed_ms + knownSinceSnapshot(page, watch);
}

/** Elapsed time if the run has continued since the end of its data, for deadlines and ages only. Reads signals. */
export function assumedElapsed(
  page: LinkedPage,
  watch: Pick<Watch, "now">,
  now_ms: number,
): number {
  const now = watch.now.value;
  if (!now) return 0;
  const { run, snapshot, snapshot_ms } = now;
  if (run.phase !== "live" || !snapshot || snapshot_ms === null) return run.length_ms;
  const there_ms = now_ms + (page.server.pulse.value?.ahead_ms ?? 0);
  return snapshot.elapsed_ms + Math.max(0, there_ms - snapshot_ms);
}

/** Extent of the run in ns for a time line: the end of its data, and at least its last event. Reads signals. */
export function extent_ns(page: LinkedPage, watch: Confirmed & Pick<Watch, "journal">): number {
  const { journal, now } = watch;
  const lastEvent_ns = journal.length > 0 ? journal.t_ns(journal.length - 1) : 0;
  const isLive = now.value?.run.phase === "live" && now.value.link !== "over";
  return isLive ? Math.max(lastEvent_ns, elapsedAtDataEnd(page, watch) * 1e6) : lastEvent_ns;
}

/** Time from the latest snapshot to the end of the data, which the durations of its active states lack. 0 for a past moment. Reads
 * signals. */
export function sinceSnapshot(
  page: LinkedPage,
  watch: Confirmed & Pick<Watch, "playhead">,
): number {
  const now = watch.now.value;
  if (watch.playhead.value !== null || !now) return 0;
  if (now.run.phase === "crashed") return untilCrash(now);
  return now.run.phase === "live" ? knownSinceSnapshot(page, watch) : 0;
}

/** True if the robot has events after the shown snapshot: the snapshot's states may have ended. Reads signals. */
export function isSnapshotOutdated({ now, journal }: Pick<Watch, "now" | "journal">): boolean {
  const { robot, snapshot, run } = now.value ?? {};
  if (!robot?.missing || !snapshot || !run) return false;
  return snapshot.sequence < Math.max(journal.next - 1, run.events) + robot.missing;
}

function knownSinceSnapshot(page: LinkedPage, watch: Confirmed): number {
  const snapshot_ms = watch.now.value?.snapshot_ms ?? null;
  const end_ms = dataEnd(page, watch);
  return snapshot_ms === null || end_ms === null ? 0 : Math.max(0, end_ms - snapshot_ms);
}

/** Time from the last snapshot to the crash. */
function untilCrash({ run, snapshot }: RunNow): number {
  return snapshot ? Math.max(0, run.length_ms - snapshot.elapsed_ms) : 0;
}

/** Time since a server time. A delay on the way counts. */
function sinceServerTime({ server }: LinkedPage, then_ms: number | null, now_ms: number): number {
  const there_ms = now_ms + (server.pulse.value?.ahead_ms ?? 0);
  return Math.max(0, there_ms - (then_ms ?? there_ms));
}

/** Last confirmation by the server. Null before the first one. */
function confirmedByServer({ server }: LinkedPage, watch: Confirmed): number | null {
  const heard_ms = watch.isCurrent.value ? (server.pulse.value?.server_ms ?? 0) : 0;
  const proven_ms = watch.proven_ms.value;
  return proven_ms === null ? null : Math.max(heard_ms, proven_ms);
}

/** Last contact of the server with the robot, or with the program of the run. Contact with a program is continuous while its link is
 * up. */
function programHeard({ link, robot, runner_heard_ms, run }: RunNow): number {
  if (link !== "up") return runner_heard_ms ?? run.started_ms;
  return robot?.heard_ms ?? Number.POSITIVE_INFINITY;
}
