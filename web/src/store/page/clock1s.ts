/** Time of this browser's clock, updated once a second, for ages on display. Without listeners no timer runs. */

import { type ReadonlySignal, signal } from "@preact/signals-core";

const EVERY_MS = 1_000;

let timer: ReturnType<typeof setInterval> | undefined;

const time = signal(Date.now(), {
  watched: () => {
    timer = setInterval(tick, EVERY_MS);
    queueMicrotask(tick);
  },
  unwatched: () => clearInterval(timer),
});

function tick(): void {
  time.value = Date.now();
}

/** ms since 1970. */
export const clock1s: ReadonlySignal<number> = time;
