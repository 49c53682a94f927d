/** Loads later parts of the page in the background, so that they appear immediately and without the server. On a slow network, visible
 * parts have priority. */

import { effect } from "@preact/signals-core";
import type { Page } from "../store/page/page.ts";
import { preloadAll } from "../ui/on_demand.tsx";
import { LATER_DIALOGS } from "./dialogs/dialogs.tsx";
import { LATER } from "./panels.tsx";

/** A network counts as quick if a question and its answer take no longer. */
const QUICK_MS = 250;

/** Begins as soon as the network has shown that it is quick. */
export function preloadParts(page: Page): () => void {
  let isBegun = false;
  return effect(() => {
    const delay_ms = page.server.pulse.value?.delay_ms ?? null;
    if (isBegun || delay_ms === null || delay_ms > QUICK_MS) return;
    isBegun = true;
    void preloadEverything();
  });
}

/** Loads what asks robots for watched values once a run of a robot is in front. */
export function watchRobotsOnceThereAre(page: Page): () => void {
  let isBegun = false;
  let isOver = false;
  let stop = () => {};
  const unfollow = effect(() => {
    if (isBegun || !page.active.value?.run.value?.now.value?.robot) return;
    isBegun = true;
    import("./watch_robots.ts").then(
      ({ watchRobots }) => {
        if (!isOver) stop = watchRobots(page);
      },
      // The server is not reachable; with the next message it may be.
      () => {
        isBegun = false;
      },
    );
  });
  return () => {
    isOver = true;
    unfollow();
    stop();
  };
}

async function preloadEverything(): Promise<void> {
  await preloadAll([...LATER, ...LATER_DIALOGS]);
  const [{ SCRIPT_PARTS }, { DESCRIPTION_PARTS }] = await Promise.all([
    import("../panels/inspector/script.tsx"),
    import("../panels/inspector/description.tsx"),
  ]);
  await preloadAll([...SCRIPT_PARTS, ...DESCRIPTION_PARTS]);
}
