/** Title of the browser tab: the current machine, the state of its run, and a dot for unsaved edits. */

import { effect } from "@preact/signals-core";
import { isChanged } from "../commands/save.ts";
import { type RunWord, runStatusWords } from "../model/run_words.ts";
import type { Watch } from "../store/history/run.ts";
import type { Page } from "../store/page/page.ts";
import { countUnacknowledged } from "../store/run/acknowledged.ts";

/** Signs of active runs; `❗` while something needs attention. */
const SIGNS: Readonly<Partial<Record<RunWord, string>>> = {
  starting: "▶ ",
  running: "▶ ",
  waiting: "▶ ",
  paused: "⏸ ",
  stepping: "⏸ ",
  stopping: "■ ",
  crashed: "❗ ",
  diverged: "❗ ",
};

export function titleOf(page: Page): string {
  const tab = page.active.value;
  if (!tab) return "RAFCON";
  const name = tab.session.status.value?.summary.name ?? tab.run.value?.now.value?.run.name;
  return `${signOf(tab.run.value)}${isChanged(tab) ? "• " : ""}${name ?? "machine"} – RAFCON`;
}

function signOf(watch: Watch | null): string {
  const now = watch?.now.value;
  const sign = now ? SIGNS[runStatusWords(now).word] : undefined;
  if (!sign) return "";
  return countUnacknowledged(watch) > 0 ? "❗ " : sign;
}

export function keepTitle(page: Page, sheet: Document): () => void {
  return effect(() => {
    const title = titleOf(page);
    if (sheet.title !== title) sheet.title = title;
  });
}
