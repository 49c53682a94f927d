/** Tells others which states are selected here, in the machine in front; not more often than they can see. */

import { effect } from "@preact/signals-core";
import type { OpenTab } from "../store/page.ts";
import { touchedStates } from "../store/selection.ts";
import type { Server } from "../store/server.ts";
import type { Clock } from "./clock.ts";

/** Two tellings are at least so far apart. */
const EVERY_MS = 50;
/** What the server takes: so many paths of so many bytes together. */
const COUNT_MAX = 1_000;
const LENGTH_MAX = 20_000;

/** Goes on until the returned function is called. */
export function tellPresence(
  server: Server,
  active: () => OpenTab | null,
  clock: Clock,
): () => void {
  let cancel: (() => void) | null = null;
  let isDirty = false;
  const now = () => {
    const tab = active();
    if (server.link.peek().state !== "up" || !tab) return;
    const selection = bounded(touchedStates(tab.view));
    server.say({ frame: "presence", machine: tab.room.id, selection: [...selection] });
  };
  const pause = () => {
    cancel = clock.after(EVERY_MS, () => {
      cancel = null;
      if (!isDirty) return;
      isDirty = false;
      now();
      pause();
    });
  };
  const stop = effect(() => {
    const tab = active();
    if (tab) touchedStates(tab.view);
    if (server.link.value.state !== "up") return;
    if (cancel) {
      isDirty = true;
      return;
    }
    now();
    pause();
  });
  return () => {
    stop();
    cancel?.();
  };
}

function bounded(paths: readonly string[]): readonly string[] {
  let length = 0;
  return paths.slice(0, COUNT_MAX).filter((path) => {
    length += path.length;
    return length <= LENGTH_MAX;
  });
}
