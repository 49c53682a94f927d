/** Compares the machine of a tab with that of its run. The layout is ignored. */

import { effect, type ReadonlySignal, signal } from "@preact/signals-core";
import { differences } from "../../model/difference.ts";
import type { Document } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { perOwner } from "../../model/per_owner.ts";
import { machineOf } from "../../model/plain_machine.ts";
import type { Runs, Watch } from "../history/run.ts";
import { LatestRequest } from "../page/latest_request.ts";
import type { OpenTab } from "../page/page.ts";

/** Delay from the last change to the comparison. */
const SETTLED_MS = 300;
/** Retry interval of a failed request. */
const AGAIN_MS = 2_000;

const differencesOf = perOwner((tab: OpenTab) =>
  perOwner((watch: Watch, runs: Runs) => followed(tab, watch, runs)),
);

/** Signal for a tab and a run: true if the machines differ. It is updated only while it has listeners. */
export function differsFromRun(tab: OpenTab, watch: Watch, runs: Runs): ReadonlySignal<boolean> {
  return differencesOf(tab)(watch, runs);
}

function followed({ session }: OpenTab, watch: Watch, runs: Runs): ReadonlySignal<boolean> {
  let ran: Machine | null = null;
  /** Hash of the loaded machine; null for none. */
  let known: string | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let stops: readonly (() => void)[] = [];
  const compare = () => {
    differs.value =
      ran !== null && differences(ran, session.machine).some(({ isLayout }) => !isLayout);
  };
  const soon = () => {
    clearTimeout(timer);
    timer = setTimeout(compare, SETTLED_MS);
  };
  const request = new LatestRequest<string, Document>({
    ask: (root) => {
      const query = root === "" ? "" : `?root=${encodeURIComponent(root)}`;
      return runs.get(watch.id, `machine${query}`);
    },
    take: (document, root) => {
      ran = machineOf(document);
      known = root;
      compare();
    },
    // A machine may not be stored yet.
    isRepeated: () => true,
    again_ms: AGAIN_MS,
  });
  const look = () => {
    const wanted = rootOf(watch);
    // Before the first event of the run, its machine may not be stored yet.
    if (watch.journal.length === 0) return;
    if (wanted === known) request.drop();
    else request.want(wanted);
  };
  const differs = signal(false, {
    watched: () => {
      if (session.fixed !== null) return;
      stops = [session.onChange(soon), effect(look)];
      soon();
    },
    unwatched: () => {
      clearTimeout(timer);
      request.drop();
      for (const stop of stops) stop();
    },
  });
  return differs;
}

const lastRoot = perOwner((_journal: Watch["journal"]) => ({ at: 0, root: "" }));

/** Hash of the machine that the run uses, from its journal; empty for the machine of the start. */
function rootOf(watch: Watch): string {
  watch.journalVersion.value;
  const found = lastRoot(watch.journal);
  for (; found.at < watch.journal.length; found.at += 1) {
    const event = watch.journal.other(found.at);
    if (event?.type === "root") found.root = event.hash;
  }
  return found.root;
}
