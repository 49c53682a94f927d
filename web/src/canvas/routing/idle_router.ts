/** Routes lines that will soon be visible while the browser is idle. */

import type { LayoutNode } from "../layout/layout_node.ts";

/** Idle time that is left to other tasks, in ms. */
const LEAST_MS = 6;

export class IdleRouter {
  #open: LayoutNode[] = [];
  #asked = 0;

  /** Replaces the list of states whose lines are routed ahead. */
  look(states: readonly LayoutNode[]): void {
    this.#open = [...states];
    if (this.#open.length > 0 && this.#asked === 0) this.#ask();
  }

  stop(): void {
    this.#open = [];
    if (this.#asked !== 0) cancelIdleCallback(this.#asked);
    this.#asked = 0;
  }

  #ask(): void {
    if (typeof requestIdleCallback === "undefined") return;
    this.#asked = requestIdleCallback((left) => {
      this.#asked = 0;
      while (this.#open[0]?.wire(() => left.timeRemaining() > LEAST_MS)) this.#open.shift();
      if (this.#open.length > 0) this.#ask();
    });
  }
}
