/** Starts runs: asks about unsaved edits, then starts the machine on the disk with its stored breakpoints. */

import { effect } from "@preact/signals-core";
import type { Breakpoint, MachineFile } from "../model/generated/protocol.ts";
import { drafts } from "../store/document/drafts.ts";
import type { Start, Watch } from "../store/history/run.ts";
import type { OpenTab } from "../store/page/page.ts";
import { wallTime } from "../store/page/times.ts";
import { keptBreakpoints } from "../store/run/breakpoints.ts";
import { fileOfTab, runningBeside } from "../store/run/running.ts";
import type { CommandContext } from "./command.ts";
import { lacks } from "./run_rules.ts";
import { isChanged, saveTab } from "./save.ts";
import { canEdit } from "./subject.ts";

/** Starts a run of the current machine and shows it; null if the user cancels. */
export async function startRun(
  context: CommandContext,
  more: Partial<Start> = {},
): Promise<Watch | null> {
  const { page, tab } = context;
  if (!tab || !(await confirmAnother(context, tab))) return null;
  const machine = await asOnDisk(context, tab);
  if (!machine || !(await confirmErrors(context, tab))) return null;
  const breakpoints = allowed(context, keptBreakpoints(tab).peek());
  const id = await page.runs.start({ breakpoints, ...more, machine });
  await page.showRun(id);
  introduceTimeline(context);
  return page.runs.watch(id);
}

/** Shows the time line at the first start in a browser, because nothing else hints at it. */
function introduceTimeline({ page, shell }: CommandContext): void {
  const settings = page.settings.peek();
  if (settings.knowsTimeline || !shell.layouts.isShown("bottom")) return;
  page.settings.value = { ...settings, knowsTimeline: true };
  shell.showPanel("timeline");
}

/** A second active run is rarely intended, because a robot has one body. */
async function confirmAnother({ page, shell }: CommandContext, tab: OpenTab): Promise<boolean> {
  const live = runningBeside(page, tab);
  const [first] = live;
  if (!first) return true;
  const name = first.name === "" ? "this machine" : `“${first.name}”`;
  const active =
    live.length === 1 ? `A run of ${name} is active` : `${live.length} runs of ${name} are active`;
  const began = wallTime(first.started_ms, Date.now());
  const by = first.author === null ? "" : ` by ${first.author}`;
  return shell.confirm({
    title: "Start another run?",
    text: `${active}, started ${began}${by}. The runs would be active concurrently, perhaps on one robot.`,
    yes: "Start another",
    danger: true,
  });
}

/** A machine with errors is started only if that is meant. */
async function confirmErrors({ shell }: CommandContext, tab: OpenTab): Promise<boolean> {
  const problems = tab.session.fixed === null ? await tab.session.check() : null;
  const errors = (problems ?? []).filter(({ severity }) => severity === "error");
  if (errors.length === 0) return true;
  const shown = errors.slice(0, ERRORS_SHOWN).map(({ message }) => message);
  const more = errors.length - shown.length;
  const rest = more > 0 ? [`… and ${more} more.`] : [];
  const choice = await shell.choose({
    title: errors.length === 1 ? "Start with an error?" : `Start with ${errors.length} errors?`,
    text: "The check of the machine found:",
    list: [...shown, ...rest],
    safe: SHOW_ERRORS.value,
    choices: [SHOW_ERRORS, START_ANYWAY],
  });
  if (choice === SHOW_ERRORS.value) shell.showPanel("problems");
  return choice === START_ANYWAY.value;
}

/** Limit of the errors listed before a start. */
const ERRORS_SHOWN = 3;
const SHOW_ERRORS = { value: "show", title: "Show the problems" } as const;
const START_ANYWAY = {
  value: "start",
  title: "Start anyway",
  detail: "States with errors abort, or the run waits there.",
} as const;

/** The folder of the machine, saved on request; null if the user cancels. */
async function asOnDisk(context: CommandContext, tab: OpenTab): Promise<MachineFile | null> {
  if (tab.session.fixed !== null) {
    const file = fileOfTab(tab);
    if (!file) throw new Error("the machine of this run is not in any project");
    return file;
  }
  if (fileOfTab(tab) === null) return savedFirst(context, tab);
  if (!hasUnsaved(tab)) return fileOfTab(tab);
  const choice = await context.shell.choose({
    title: "Save before starting?",
    text: "The machine has unsaved edits. A run uses the saved machine.",
    safe: canEdit(context) ? SAVE.value : null,
    choices: canEdit(context) ? [SAVE, AS_IS] : [AS_IS],
  });
  if (choice === "save") return (await saveTab(context, tab)) ? fileOfTab(tab) : null;
  return choice === "as-is" ? fileOfTab(tab) : null;
}

const SAVE = { value: "save", title: "Save and start" } as const;
const AS_IS = {
  value: "as-is",
  title: "Start the saved machine",
  detail: "The edits stay here and do not affect the run.",
} as const;

function hasUnsaved(tab: OpenTab): boolean {
  const hasDrafts = [...drafts.all.peek().values()].some(
    ({ machine }) => machine === tab.session.id,
  );
  return isChanged(tab) || hasDrafts || tab.session.pending.peek().length > 0;
}

async function savedFirst(context: CommandContext, tab: OpenTab): Promise<MachineFile | null> {
  const isSaved = await saveTab(context, tab);
  return isSaved ? until(() => tab.session.status.value?.summary.file ?? null) : null;
}

/** Waits until a function of signals gives something. */
function until<T>(read: () => T | null): Promise<T> {
  return new Promise((found) => {
    let stop: () => void = () => {};
    let isFound = false;
    stop = effect(() => {
      const value = read();
      if (value === null || isFound) return;
      isFound = true;
      found(value);
      queueMicrotask(() => stop());
    });
  });
}

/** Conditions are Python. Users without the right to edit start without such breakpoints, which is reported. */
function allowed({ page }: CommandContext, all: readonly Breakpoint[]): Breakpoint[] {
  if (lacks(page, "edit") === null) return [...all];
  const plain = all.filter(({ condition }) => condition === null);
  if (plain.length < all.length) {
    const text =
      "Breakpoints with conditions are left out: a condition is Python code, which only engineers may add to a run.";
    page.tell({ level: "warning", text });
  }
  return plain;
}
