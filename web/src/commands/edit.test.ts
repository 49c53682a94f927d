import { expect, test } from "vitest";
import { machineOf } from "../model/plain_machine.ts";
import { sketch } from "../model/testing/sketch.ts";
import { besides } from "./edit.ts";

const MACHINE = machineOf(
  sketch(`
    R hierarchy 0 0 400 300
      A execution 20 20 100 100
      B execution 140 20 100 100
      C execution 280 20 100 100
      D execution 20 140 100 150
  `),
);

test("a duplicate stands beside its original, below it, or a little shifted where there is no room", () => {
  expect(besides(MACHINE, ["R/A"])).toEqual({ x: 12, y: 12 });
  expect(besides(MACHINE, ["R/B"])).toEqual({ x: 0, y: 120 });
  expect(besides(MACHINE, ["R/D"])).toEqual({ x: 120, y: 0 });
});
