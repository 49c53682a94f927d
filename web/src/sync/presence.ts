/** Tells others which states are selected here, in the machine in front; not more often than they can see. */

import { effect } from "@preact/signals-core";
import type { OpenTab } from "../store/page/page.ts";
import { touchedStates } from "../store/page/selection.ts";
import type { Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

/** Shortest interval of two messages, in ms. */
const EVERY_MS = 50;
/** Limits of the server: number of paths and their total bytes. */
const COUNT_MAX = 1_000;
const LENGTH_MAX = 20_000;

/** Goes on until the returned function is called. */
export function tellPresence(
  server: Server,
  active: () => OpenTab | null,
  clock: Clock,
): () => void {
  let cancel: (() => void) | null = null;
  let lastSent = "";
  const tell = () => {
    cancel = null;
    const frame = presence(server, active());
    if (!frame) return;
    lastSent = JSON.stringify(frame);
    server.say(frame);
    cancel = clock.after(EVERY_MS, () => {
      cancel = null;
      if (JSON.stringify(presence(server, active())) !== lastSent) tell();
    });
  };
  const stop = effect(() => {
    const frame = presence(server, active());
    const isKnown = isListed(server, active()) && JSON.stringify(frame) === lastSent;
    if (frame && !isKnown && !cancel) tell();
  });
  return () => {
    stop();
    cancel?.();
  };
}

/** The next message; null without a connection or an open machine. */
function presence(server: Server, tab: OpenTab | null) {
  if (server.link.value.state !== "up" || !tab) return null;
  const selection = [...bounded(touchedStates(tab.view))];
  return { frame: "presence", machine: tab.session.id, selection } as const;
}

/** True if the server lists this connection as a viewer. Closing and reopening a machine clears the list. */
function isListed(server: Server, tab: OpenTab | null): boolean {
  const link = server.link.value;
  const people = tab?.session.status.value?.people ?? [];
  return link.state === "up" && people.some(({ connection }) => connection === link.connection);
}

function bounded(paths: readonly string[]): readonly string[] {
  let length = 0;
  return paths.slice(0, COUNT_MAX).filter((path) => {
    length += path.length;
    return length <= LENGTH_MAX;
  });
}
