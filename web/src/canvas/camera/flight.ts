/** Moves the camera to a goal: as an animation, or at once for users who prefer reduced motion. */

import type { Signal } from "@preact/signals-core";
import type { Camera } from "../../store/page/view.ts";
import { flight } from "./camera.ts";

/** Source of animation frames: the window, or a stub in tests. */
export interface Frames {
  readonly now: () => number;
  readonly request: (frame: () => void) => number;
  readonly drop: (request: number) => void;
  /** True if the user prefers reduced motion. */
  readonly prefersReducedMotion: () => boolean;
}

const DURATION_MS = 280;

export class Flight {
  readonly #camera: Signal<Camera>;
  readonly #frames: Frames;
  #request: number | null = null;
  #goal: Camera | null = null;

  constructor(camera: Signal<Camera>, frames: Frames) {
    this.#camera = camera;
    this.#frames = frames;
  }

  /** Camera at the end of the flight; the current camera if there is none. */
  get goal(): Camera {
    return this.#goal ?? this.#camera.peek();
  }

  to(goal: Camera): void {
    this.stop();
    this.#goal = goal;
    if (this.#frames.prefersReducedMotion()) {
      this.#camera.value = goal;
      this.#goal = null;
      return;
    }
    this.#step(this.#camera.peek(), goal, this.#frames.now());
  }

  /** Stops the flight. The camera keeps its current position. */
  stop(): void {
    if (this.#request !== null) this.#frames.drop(this.#request);
    this.#request = null;
    this.#goal = null;
  }

  #step(from: Camera, goal: Camera, start: number): void {
    const part = Math.min(1, (this.#frames.now() - start) / DURATION_MS);
    this.#camera.value = flight(from, goal, 1 - (1 - part) ** 3);
    if (part === 1) this.#goal = null;
    this.#request = part < 1 ? this.#frames.request(() => this.#step(from, goal, start)) : null;
  }
}

/** Animation frames of the window. */
export const WINDOW_FRAMES: Frames = {
  now: () => performance.now(),
  request: (frame) => requestAnimationFrame(frame),
  drop: (request) => cancelAnimationFrame(request),
  prefersReducedMotion: () => matchMedia("(prefers-reduced-motion: reduce)").matches,
};
