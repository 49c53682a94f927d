/** Notices on shown runs while mission control is hidden: questions, failures, crashes, control, and states that take longer than ever.
 * Each is reported once; failures share one notice with a counter. Warnings count in the badges only. */

import { effect } from "@preact/signals-core";
import { MISSION_PANEL } from "../commands/mission.ts";
import type { Control } from "../model/generated/protocol.ts";
import { duration } from "../panels/parts/duration.ts";
import { nameWhenLoaded } from "../store/document/name_when_loaded.ts";
import { didInWords, type RunFailure } from "../store/history/failures.ts";
import { openQuestions } from "../store/history/questions.ts";
import type { Watch } from "../store/history/run.ts";
import { clock1s } from "../store/page/clock1s.ts";
import type { Notice, OpenTab } from "../store/page/page.ts";
import { openFailures } from "../store/run/acknowledged.ts";
import { usualInWords } from "../store/run/baseline.ts";
import { type Longer, longerThanEver } from "../store/run/longer.ts";
import { sessionOfPage, summaryOf } from "../store/run/running.ts";
import type { AppSession } from "./session.ts";

/** Simultaneous failures share a notice. */
const TOGETHER_MS = 1_000;

/** From now on, for every tab that shows a run. */
export function tellOfRuns(session: AppSession): () => void {
  const stopByWatch = new Map<Watch, () => void>();
  const stop = effect(() => {
    const tabs = session.page.tabs.value;
    const shown = new Map<Watch, OpenTab>();
    for (const tab of tabs) {
      const watch = tab.run.value;
      if (watch) shown.set(watch, tab);
    }
    for (const [watch, tab] of shown) {
      if (!stopByWatch.has(watch)) stopByWatch.set(watch, tellOfRun(session, tab, watch));
    }
    for (const [watch, end] of stopByWatch) {
      if (shown.has(watch)) continue;
      end();
      stopByWatch.delete(watch);
    }
  });
  return () => {
    stop();
    for (const end of stopByWatch.values()) end();
  };
}

interface RunNews {
  readonly topic: string;
  readonly level: Notice["level"];
  readonly text: string;
  /** Label of the button. */
  readonly title: string;
}

type Tell = (news: RunNews) => void;

function tellOfRun(session: AppSession, tab: OpenTab, watch: Watch): () => void {
  const { page, dock } = session;
  const tell: Tell = ({ topic, level, text, title }) => {
    const isSeen = page.active.peek()?.run.peek() === watch && dock.peek().isInSight(MISSION_PANEL);
    if (isSeen) return;
    const action = { title, command: "mission.show", argument: watch.id } as const;
    const passing = { topic: `${watch.id} ${topic}`, machine: tab.session.id };
    page.tell({ level, text, action, passing });
  };
  const name = () => summaryOf(page, watch)?.name ?? watch.id;
  const stops = [
    tellQuestions(watch, tab, tell),
    tellFailures(watch, tab, tell),
    tellLonger(session, watch, tab),
    // A bar reports the crash of the current machine's run.
    tellCrash(watch, name, (news) => page.active.peek() !== tab && tell(news)),
    tellControl(session, watch, name, tell),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

function tellQuestions(watch: Watch, { session }: OpenTab, tell: Tell): () => void {
  const known = new Set<number>();
  return effect(() => {
    for (const { id, path, message } of openQuestions(watch)) {
      if (known.has(id)) continue;
      known.add(id);
      void nameWhenLoaded(session, path).then((name) => {
        const text = `${name} asks: ${message}`;
        tell({ topic: `question ${id}`, level: "warning", text, title: "Answer" });
      });
    }
  });
}

/** Events before the page was up to date are no news. */
function tellFailures(watch: Watch, { session }: OpenTab, tell: Tell): () => void {
  let from = Number.POSITIVE_INFINITY;
  let reportedSequence = 0;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const say = async () => {
    timer = undefined;
    const fresh = failuresSince(openFailures(watch).peek(), from);
    const last = newest(fresh);
    if (!last || last.sequence === reportedSequence) return;
    reportedSequence = last.sequence;
    const name = last.path === "" ? "" : await nameWhenLoaded(session, last.path);
    const text = failuresInWords(last, fresh.length, name);
    tell({ topic: "failures", level: "error", text, title: "Show" });
  };
  const stop = effect(() => {
    const all = openFailures(watch).value;
    if (from === Number.POSITIVE_INFINITY) {
      if (watch.isCaughtUp.value) from = watch.journal.next;
      return;
    }
    const last = newest(failuresSince(all, from));
    if (last && last.sequence !== reportedSequence)
      timer ??= setTimeout(() => void say(), TOGETHER_MS);
  });
  return () => {
    stop();
    clearTimeout(timer);
  };
}

function newest(all: readonly RunFailure[]): RunFailure | undefined {
  return all.reduce<RunFailure | undefined>(
    (last, each) => (last && last.sequence > each.sequence ? last : each),
    undefined,
  );
}

/** Reported failures: neither warnings nor the effects of a crash, which has its own notice. */
export function failuresSince(all: readonly RunFailure[], from: number): readonly RunFailure[] {
  return all.filter(
    ({ sequence, level, kind }) => sequence >= from && level === "error" && kind !== "crash",
  );
}

/** The newest one, and how many there are. */
export function failuresInWords(
  { kind, text }: Pick<RunFailure, "kind" | "text">,
  count: number,
  name: string,
): string {
  const did = [name, didInWords(kind)].filter((part) => part !== "").join(" ");
  const last = [did, text].filter((part) => part !== "").join(": ");
  return count === 1 ? last : `${count} failures, the latest: ${last}`;
}

/** Once for each time that a state takes longer than ever: it may hang. It is kept in the log, whatever is in sight. */
function tellLonger({ page }: AppSession, watch: Watch, { session }: OpenTab): () => void {
  const alarms = new LongerAlarms();
  return effect(() => {
    const all = longerThanEver(page, watch);
    for (const longer of alarms.due(all, clock1s.value)) {
      void nameWhenLoaded(session, longer.path).then((name) => {
        const text = longerInWords(name, longer);
        const action = {
          title: "Mission control",
          command: "mission.show",
          argument: watch.id,
        } as const;
        page.tell({ level: "warning", text, action });
      });
    }
  });
}

/** Alarms of states that run too long at two readings of the clock, because after a silence the server responds before it reads the
 * events of that time. */
export class LongerAlarms {
  /** The clock at the first reading, by path; null once the alarm was due. */
  #since = new Map<string, number | null>();

  /** Null: nothing is known now. */
  due(all: readonly Longer[] | null, now_ms: number): readonly Longer[] {
    if (all === null) return [];
    const before = this.#since;
    const isDue = ({ path }: Longer) => (before.get(path) ?? now_ms) < now_ms;
    const found = all.filter(isDue);
    const next = (longer: Longer) => {
      const isKnown = before.get(longer.path) === null || found.includes(longer);
      return isKnown ? null : (before.get(longer.path) ?? now_ms);
    };
    this.#since = new Map(all.map((longer) => [longer.path, next(longer)]));
    return found;
  }
}

/** `Drill has run longer than ever before: 12 s, usually 3 s, at most 5 s (14 times)`. */
export function longerInWords(name: string, { since_ms, baseline }: Omit<Longer, "path">): string {
  return `${name} has run longer than ever before: ${duration(since_ms)}, ${usualInWords(baseline, duration)}`;
}

function tellCrash(watch: Watch, name: () => string, tell: Tell): () => void {
  let before: string | null = null;
  return effect(() => {
    const phase = watch.now.value?.run.phase ?? null;
    if (phase === "diverged" && before !== null && before !== "diverged") {
      const text = `The replica of ${name()} has diverged: it takes nothing more from its robot`;
      tell({ topic: "diverged", level: "error", text, title: "Mission control" });
    }
    if (phase === "crashed" && before !== null && before !== "crashed") {
      const text = `The program of ${name()} died: the run can be resumed`;
      tell({ topic: "crash", level: "error", text, title: "Mission control" });
    }
    before = phase;
  });
}

/** A new request or offer of control to the user; null if there is none. */
function requestOf(control: Control, before: Control | null, user: string): string | null {
  const { holder, requests, offered_to } = control;
  const asker = requests.find((other) => !before?.requests.includes(other));
  if (holder === user && asker !== undefined) return `${asker} asks for`;
  const isOffered = offered_to === user && before?.offered_to !== user;
  return isOffered ? `${holder} offers you` : null;
}

function tellControl(
  { page }: AppSession,
  watch: Watch,
  name: () => string,
  tell: Tell,
): () => void {
  let before: Control | null = null;
  return effect(() => {
    const control = watch.now.value?.control;
    const user = sessionOfPage(page)?.user;
    if (!control || user === undefined) return;
    const { holder } = control;
    const request = requestOf(control, before, user);
    if (request !== null) {
      const text = `${request} control of ${name()}`;
      tell({ topic: "request", level: "warning", text, title: "Mission control" });
    }
    if (before && before.holder !== holder && (holder === user || before.holder === user)) {
      const who = holder === user ? "You are" : holder === null ? "Nobody is" : `${holder} is`;
      const text = `${who} in control of ${name()} now`;
      if (before.holder !== null)
        tell({ topic: "control", level: "info", text, title: "Mission control" });
    }
    before = control;
  });
}
