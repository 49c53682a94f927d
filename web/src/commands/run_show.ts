/** Which run is shown, at which moment, beside which other; and what becomes of runs that are over. */

import type { RunSummary } from "../model/generated/protocol.ts";
import { isLive, statusInWords, summaryStatusWords } from "../model/run_words.ts";
import { comparedRun } from "../store/history/compared_run.ts";
import { entryToStartFrom } from "../store/history/moments.ts";
import { pageBase } from "../store/page/base.ts";
import { type OpenTab, type Page, runOf } from "../store/page/page.ts";
import { wallTime } from "../store/page/times.ts";
import { liveRun, runsOfTab } from "../store/run/running.ts";
import type { CommandChoice, CommandContext, UserCommand } from "./command.ts";
import { cannotWhile, lacks, robotRefuses } from "./run_rules.ts";
import { sendCommand } from "./send_command.ts";

const NONE = "no run is shown here: start one, or choose one";

export const RUN_SHOW: readonly UserCommand[] = [
  {
    id: "run.show",
    title: "Show run",
    menu: "Run/7",
    choices: ({ page, tab }) => (tab ? runChoices(page, runsOfTab(page, tab), tab) : []),
    run: ({ page }, argument) => (argument === undefined ? undefined : page.showRun(argument)),
  },
  {
    id: "run.show-as-ran",
    title: "Show the machine as it ran",
    detail: "Opens the machine that the run uses in its own tab, next to the edited one.",
    menu: "Run/7",
    refusal: ({ page }, argument) => (runOf(page) || argument !== undefined ? null : NONE),
    run: ({ page }, argument) => {
      const id = argument ?? runOf(page)?.id;
      return id === undefined ? undefined : page.showAsRan(id);
    },
  },
  {
    id: "run.leave",
    title: "Hide run",
    detail: "Hides the run in this tab. The run continues.",
    menu: "Run/7",
    refusal: ({ page, tab }) => {
      if (tab?.session.fixed != null) return "this tab belongs to the run: close the tab";
      return runOf(page) ? null : NONE;
    },
    run: ({ tab }) => {
      if (tab) tab.run.value = null;
    },
  },
  {
    id: "run.follow",
    title: "Follow active states",
    detail: "Keeps the active states in view.",
    menu: "Run/7",
    checked: ({ tab }) => tab?.view.follows.value ?? false,
    refusal: ({ page }) => (runOf(page) ? null : NONE),
    run: ({ tab }) => {
      if (tab) tab.view.follows.value = !tab.view.follows.peek();
    },
  },
  {
    id: "run.live",
    title: "Back to now",
    detail: "Shows the current state instead of an earlier moment.",
    menu: "Run/7",
    refusal: ({ page }) => {
      const watch = runOf(page);
      if (!watch) return NONE;
      return watch.playhead.value === null ? "the current state is already shown" : null;
    },
    run: ({ page }) => {
      const watch = runOf(page);
      if (watch) watch.playhead.value = null;
    },
  },
  {
    id: "run.start-from-history",
    title: "Start from this moment",
    detail:
      "Restarts the run at an entry of its history with the data it had then, and pauses there.",
    refusal: (context) => {
      const watch = context.tab?.run.value;
      const phase = watch?.now.value?.run.phase;
      return watch && (phase === "crashed" || phase === "finished")
        ? (lacks(context.page, "start") ?? robotRefuses(watch, "start"))
        : cannotWhile(context, ["running", "paused", "stepping"]);
    },
    run: startFromHistory,
  },
  {
    id: "run.compare",
    title: "Compare with another run",
    menu: "Run/8/This run",
    refusal: ({ page }) => (runOf(page) ? null : NONE),
    choices: ({ page, tab }) => {
      const shown = tab?.run.value?.id;
      return tab
        ? runChoices(
            page,
            runsOfTab(page, tab).filter(({ id }) => id !== shown),
          )
        : [];
    },
    run: compare,
  },
  {
    id: "run.export",
    title: "Export run",
    menu: "Run/8/This run",
    refusal: ({ page }, argument) => (runOf(page) || argument !== undefined ? null : NONE),
    choices: ({ page }) => {
      const run = runOf(page)?.id;
      return run === undefined
        ? []
        : EXPORTS.map(([format, title]) => ({ title, argument: { run, format } }));
    },
    run: (_, argument) => {
      if (!argument) return;
      const { run, format } = argument;
      download(`${pageBase()}/api/v1/runs/${encodeURIComponent(run)}/export?format=${format}`);
    },
  },
  {
    id: "run.delete",
    title: "Delete run…",
    detail: "Deletes all stored data of the run.",
    menu: "Run/8/This run",
    refusal: ({ page }, argument) => {
      const id = idOf(page, argument);
      if (id === null) return NONE;
      const phase = page.runs.all.value.find((run) => run.id === id)?.phase;
      if (isLive(phase)) return "the run is active: stop it first";
      return lacks(page, "administer");
    },
    run: remove,
  },
];

const EXPORTS = [
  ["jsonl", "Events, one per line (JSONL)"],
  ["csv", "Table (CSV)"],
  ["mcap", "MCAP, for Foxglove"],
] as const;

/** The run that is meant: the one given, else the one in front. */
function idOf(page: Page, argument?: string): string | null {
  return argument ?? runOf(page)?.id ?? null;
}

function runChoices(
  page: Page,
  runs: readonly RunSummary[],
  tab?: OpenTab,
): readonly CommandChoice<string>[] {
  return runs.map((run) => ({
    title: `${wallTime(run.started_ms, Date.now())}, ${statusInWords(summaryStatusWords(run))}`,
    detail: run.id,
    argument: run.id,
    ...(tab ? { checked: runOf(page)?.id === run.id } : {}),
  }));
}

/** The argument is the number of an entry, by default the one that follows the shown moment. */
async function startFromHistory(context: CommandContext, argument?: number): Promise<void> {
  const watch = context.tab?.run.peek();
  if (!watch) return;
  const sequence = argument ?? entryToStartFrom(watch);
  if (sequence === null) return;
  if (liveRun(context.tab)) {
    const runCommand = { type: "start_from_history", sequence } as const;
    if (!(await sendCommand(context, "Start from this moment", runCommand))) return;
  } else await watch.resume("restart", sequence);
  watch.playhead.value = null;
}

function compare({ page, shell }: CommandContext, argument?: string): void {
  const watch = runOf(page);
  if (!watch) return;
  if (argument !== undefined) comparedRun(watch).value = argument;
  shell.showPanel("compare");
}

/** Saves what an address gives, as browsers do. */
function download(address: string): void {
  const link = document.createElement("a");
  link.href = address;
  link.download = "";
  link.click();
}

async function remove({ page, shell }: CommandContext, argument?: string): Promise<void> {
  const id = idOf(page, argument);
  if (id === null) return;
  const isSure = await shell.confirm({
    title: "Delete this run?",
    text: `Deletes all stored data of ${id}: events, values, the machine as it ran. This cannot be undone.`,
    yes: "Delete",
    danger: true,
  });
  if (!isSure) return;
  await page.runs.remove(id);
  for (const tab of page.tabs.peek()) {
    if (tab.run.peek()?.id !== id) continue;
    if (tab.session.fixed === null) tab.run.value = null;
    else page.leave(tab);
  }
}
