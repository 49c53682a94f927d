/** Moves the camera from where it is to where it is wanted, in a while, or at once for those who want no motion. */

import type { Signal } from "@preact/signals-core";
import type { Camera } from "../store/page/view.ts";
import { flight } from "./camera.ts";

/** What asks for frames: the window, and in tests a few lines. */
export interface Frames {
  readonly now: () => number;
  readonly request: (frame: () => void) => number;
  readonly drop: (request: number) => void;
  /** Whether the user wants things not to move. */
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

  /** Where the camera will be; where it is if it does not fly. */
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

  /** Leaves the camera where it is. */
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

/** Frames of the window. */
export const WINDOW_FRAMES: Frames = {
  now: () => performance.now(),
  request: (frame) => requestAnimationFrame(frame),
  drop: (request) => cancelAnimationFrame(request),
  prefersReducedMotion: () => matchMedia("(prefers-reduced-motion: reduce)").matches,
};
