/** Finds the ways of lines that will be needed soon, while the browser has nothing else to do. */

import type { LayoutNode } from "./layout_node.ts";

/** Less time than this is left to others. */
const LEAST_MS = 6;

export class IdleRouter {
  #open: LayoutNode[] = [];
  #asked = 0;

  /** These will be needed next, and no others. */
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
