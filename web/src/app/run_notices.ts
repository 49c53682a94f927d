/** Tells what matters of the runs that are shown while nobody looks at mission control: questions, failures, crashes, who is in
 * control. Each thing once. */

import { effect } from "@preact/signals-core";
import { MISSION_PANEL } from "../commands/mission.ts";
import { namesTo } from "../model/machine.ts";
import { openFailures } from "../store/acknowledged.ts";
import type { Failure } from "../store/failures.ts";
import type { Notice, OpenTab } from "../store/page.ts";
import { openQuestions } from "../store/questions.ts";
import type { Watch } from "../store/run.ts";
import { sessionOfPage, summaryOf } from "../store/running.ts";
import type { AppSession } from "./session.ts";

/** Failures that come together are told together. */
const TOGETHER_MS = 1_000;

/** From now on, for every tab that shows a run. */
export function tellOfRuns(session: AppSession): () => void {
  const told = new Map<Watch, () => void>();
  const stop = effect(() => {
    const tabs = session.page.tabs.value;
    const shown = new Map<Watch, OpenTab>();
    for (const tab of tabs) {
      const watch = tab.run.value;
      if (watch) shown.set(watch, tab);
    }
    for (const [watch, tab] of shown) {
      if (!told.has(watch)) told.set(watch, tellOfRun(session, tab, watch));
    }
    for (const [watch, end] of told) {
      if (shown.has(watch)) continue;
      end();
      told.delete(watch);
    }
  });
  return () => {
    stop();
    for (const end of told.values()) end();
  };
}

type Tell = (level: Notice["level"], text: string, title: string) => void;

function tellOfRun(session: AppSession, tab: OpenTab, watch: Watch): () => void {
  const { page, dock } = session;
  const tell: Tell = (level, text, title) => {
    const isSeen = page.active.peek()?.run.peek() === watch && dock.peek().isInSight(MISSION_PANEL);
    if (isSeen) return;
    const action = { title, command: "mission.show", argument: watch.id };
    page.tell({ level, text, action });
  };
  const name = () => summaryOf(page, watch)?.name ?? watch.id;
  const stops = [
    tellQuestions(watch, tab, tell),
    tellFailures(watch, tab, tell),
    tellCrash(watch, name, tell),
    tellControl(session, watch, name, tell),
  ];
  return () => {
    for (const stop of stops) stop();
  };
}

/** The name of the state alone. */
function nameOf({ room }: OpenTab, path: string): string {
  return namesTo(room.machine, path).at(-1)?.split("/").at(-1) ?? path;
}

function tellQuestions(watch: Watch, tab: OpenTab, tell: Tell): () => void {
  const known = new Set<number>();
  return effect(() => {
    for (const { id, path, message } of openQuestions(watch)) {
      if (known.has(id)) continue;
      known.add(id);
      tell("warning", `${nameOf(tab, path)} asks: ${message}`, "Answer");
    }
  });
}

/** What happened before the page had caught up is no news. */
function tellFailures(watch: Watch, tab: OpenTab, tell: Tell): () => void {
  let from = Number.POSITIVE_INFINITY;
  let waiting: readonly Failure[] = [];
  let timer: ReturnType<typeof setTimeout> | undefined;
  const say = () => {
    const [first, ...others] = waiting;
    timer = undefined;
    waiting = [];
    if (!first) return;
    const isError = [first, ...others].some(({ level }) => level === "error");
    const more = others.length === 0 ? "" : ` (and ${others.length} more)`;
    tell(isError ? "error" : "warning", `${failureInWords(first, tab)}${more}`, "Look");
  };
  const stop = effect(() => {
    const all = openFailures(watch).value;
    const last = all.at(-1)?.sequence ?? 0;
    if (from === Number.POSITIVE_INFINITY) {
      if (watch.isCaughtUp.value) from = watch.journal.next;
      return;
    }
    if (last < from) return;
    waiting = [...waiting, ...all.filter(({ sequence }) => sequence >= from)];
    from = last + 1;
    timer ??= setTimeout(say, TOGETHER_MS);
  });
  return () => {
    stop();
    clearTimeout(timer);
  };
}

function failureInWords({ kind, path, text }: Failure, tab: OpenTab): string {
  if (path === "") return text;
  const what = kind === "aborted" ? "aborted" : "";
  const said = [what, text].filter((part) => part !== "").join(": ");
  return `${nameOf(tab, path)} ${kind === "log" ? `says: ${text}` : said}`;
}

function tellCrash(watch: Watch, name: () => string, tell: Tell): () => void {
  let before: string | null = null;
  return effect(() => {
    const phase = watch.now.value?.run.phase ?? null;
    if (phase === "crashed" && before !== null && before !== "crashed") {
      tell("error", `The program of ${name()} died: the run can be taken up`, "Mission control");
    }
    before = phase;
  });
}

function tellControl(
  { page }: AppSession,
  watch: Watch,
  name: () => string,
  tell: Tell,
): () => void {
  let before: { readonly holder: string | null; readonly requests: readonly string[] } | null =
    null;
  return effect(() => {
    const control = watch.now.value?.control;
    const user = sessionOfPage(page)?.user;
    if (!control || user === undefined) return;
    const { holder, requests } = control;
    const asker = requests.find((other) => !before?.requests.includes(other));
    if (holder === user && asker !== undefined) {
      tell("warning", `${asker} asks for control of ${name()}`, "Mission control");
    }
    if (before && before.holder !== holder && (holder === user || before.holder === user)) {
      const who = holder === user ? "You are" : holder === null ? "Nobody is" : `${holder} is`;
      if (before.holder !== null)
        tell("info", `${who} in control of ${name()} now`, "Mission control");
    }
    before = { holder, requests };
  });
}
