import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import { Flight, type Frames } from "./flight.ts";

function clock(prefersReducedMotion: boolean): Frames & { readonly pass: (ms: number) => void } {
  let now = 0;
  let next: (() => void) | null = null;
  return {
    now: () => now,
    request: (frame) => {
      next = frame;
      return 1;
    },
    drop: () => {
      next = null;
    },
    prefersReducedMotion: () => prefersReducedMotion,
    pass: (ms) => {
      now += ms;
      const frame = next;
      next = null;
      frame?.();
    },
  };
}

const GOAL = { x: 100, y: 50, scale: 4 };

test("the camera flies and arrives exactly", () => {
  const camera = signal({ x: 0, y: 0, scale: 1 });
  const frames = clock(false);
  const flight = new Flight(camera, frames);
  flight.to(GOAL);
  frames.pass(100);
  expect(flight.goal).toEqual(GOAL);
  expect(camera.value.scale).toBeGreaterThan(1);
  expect(camera.value.scale).toBeLessThan(4);
  frames.pass(1000);
  expect(camera.value).toEqual(GOAL);
});

test("without motion it is there at once", () => {
  const camera = signal({ x: 0, y: 0, scale: 1 });
  new Flight(camera, clock(true)).to(GOAL);
  expect(camera.value).toEqual(GOAL);
});

test("whoever takes over stops it where it is", () => {
  const camera = signal({ x: 0, y: 0, scale: 1 });
  const frames = clock(false);
  const flight = new Flight(camera, frames);
  flight.to(GOAL);
  frames.pass(100);
  const here = camera.value;
  flight.stop();
  frames.pass(1000);
  expect(camera.value).toBe(here);
});
