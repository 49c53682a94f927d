/** Follows the values of a robot's run that its station gets ahead of their events: only those that are watched, and only if any are. */

import type { Topic, WatchTarget } from "../model/generated/protocol.ts";
import { aheadKey, NOTHING_AHEAD } from "../store/history/ahead.ts";
import type { Watch } from "../store/history/run.ts";
import type { Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

/** Several changes of the watched values at once make one request. */
const SETTLE_MS = 300;

interface AheadPorts {
  readonly server: Server;
  readonly clock: Clock;
}

export class AheadFollower {
  readonly #watch: Watch;
  readonly #ports: AheadPorts;
  #targets: readonly WatchTarget[] = [];
  #asked = "[]";
  #isSoon = false;
  #isOver = false;
  #unfollow: () => void = () => {};

  constructor(watch: Watch, ports: AheadPorts) {
    this.#watch = watch;
    this.#ports = ports;
  }

  /** This is watched from now on. */
  watch(targets: readonly WatchTarget[]): void {
    this.#targets = targets;
    if (this.#isSoon) return;
    this.#isSoon = true;
    this.#ports.clock.after(SETTLE_MS, () => {
      this.#isSoon = false;
      this.#ask();
    });
  }

  close(): void {
    this.#isOver = true;
    this.#unfollow();
    this.#watch.ahead.value = NOTHING_AHEAD;
  }

  #ask(): void {
    const asked = JSON.stringify(this.#targets);
    if (asked === this.#asked || this.#isOver) return;
    this.#asked = asked;
    this.#unfollow();
    this.#unfollow = () => {};
    if (this.#targets.length === 0) {
      this.#watch.ahead.value = NOTHING_AHEAD;
      return;
    }
    const topic: Topic = { topic: "run_watched", run: this.#watch.id, targets: [...this.#targets] };
    this.#unfollow = this.#ports.server.follow({
      topic: () => topic,
      frame: (frame) => {
        if (frame.frame !== "run_watched") return;
        const values = new Map(frame.values.map((value) => [aheadKey(value), value]));
        this.#watch.ahead.value = { watching: frame.watching, values };
      },
    });
  }
}
