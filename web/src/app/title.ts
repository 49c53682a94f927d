/** What the browser's tab says: the machine in front, with a dot while it has edits that do not lie on disk. */

import { effect } from "@preact/signals-core";
import { isChanged } from "../commands/file.ts";
import type { Page } from "../store/page.ts";

export function titleOf(page: Page): string {
  const tab = page.active.value;
  if (!tab) return "RAFCON";
  const name = tab.room.status.value?.summary.name ?? "machine";
  return `${isChanged(tab) ? "• " : ""}${name} – RAFCON`;
}

export function keepTitle(page: Page, sheet: Document): () => void {
  return effect(() => {
    sheet.title = titleOf(page);
  });
}
