/** Asks for what the user watches of a robot's run, as long as the run is in front: what is not watched costs the link nothing. */

import { effect } from "@preact/signals-core";
import type { Watch } from "../store/history/run.ts";
import type { Page } from "../store/page/page.ts";
import { wishOf } from "../store/run/ahead.ts";
import { watchedStatesOf } from "../store/run/watched_states.ts";
import { watchedOf } from "../store/run/watched_values.ts";
import { AheadFollower } from "../sync/ahead_follower.ts";
import { WALL_CLOCK } from "../sync/clock.ts";

/** From now on, for the tab in front. */
export function watchRobots(page: Page): () => void {
  let before: Watch | null = null;
  let follower: AheadFollower | null = null;
  const stop = effect(() => {
    const tab = page.active.value;
    const watch = tab?.run.value ?? null;
    const isOfRobot = (watch?.now.value?.robot ?? null) !== null;
    const targets = tab && isOfRobot ? watchedOf(tab).value.map(({ target }) => target) : [];
    const wish = wishOf(targets, tab && isOfRobot ? watchedStatesOf(tab).value : []);
    if (before !== watch) {
      follower?.close();
      follower = watch && new AheadFollower(watch, { server: page.server, clock: WALL_CLOCK });
      before = watch;
    }
    follower?.watch(wish);
  });
  return () => {
    stop();
    follower?.close();
  };
}
