/** Gathers what open machines report when a server comes back, so that a restart is one notice however many tabs there are. Knows
 * words and a clock, not what a machine is. */

import { joinFew } from "../model/join_few.ts";
import type { Page } from "../store/page/page.ts";
import type { Clock } from "./clock.ts";

/** News that come within this time are one notice. */
const GATHER_MS = 1_000;

export interface ReturnNews {
  /** The machine was read again as a whole. */
  readonly reloaded: (name: string) => void;
  /** The machine has unsaved edits that the server before had confirmed. */
  readonly restored: (name: string) => void;
}

export function gatherReturnNews(clock: Clock, tell: Page["tell"]): ReturnNews {
  const reloaded = new Set<string>();
  const restored = new Set<string>();
  const note = (names: Set<string>, name: string) => {
    if (reloaded.size + restored.size === 0) {
      clock.after(GATHER_MS, () => {
        tell({ level: "info", text: returnInWords([...reloaded], [...restored]) });
        reloaded.clear();
        restored.clear();
      });
    }
    names.add(name);
  };
  return {
    reloaded: (name) => note(reloaded, name),
    restored: (name) => note(restored, name),
  };
}

function returnInWords(reloaded: readonly string[], restored: readonly string[]): string {
  const sentences = [];
  if (reloaded.length > 0) sentences.push(`Reloaded from the server: ${joinFew(reloaded)}.`);
  if (restored.length > 0) {
    sentences.push(
      `Unsaved edits from before the server ended are restored: ${joinFew(restored)}.`,
    );
  }
  return sentences.join(" ");
}
