import { expect, test } from "vitest";
import { inOrder } from "./order.ts";
import { machineOf } from "./plain_machine.ts";
import { sketch } from "./testing/sketch.ts";

function check(text: string, expected: string): void {
  const machine = machineOf(sketch(text));
  expect(
    inOrder(machine, "R")
      .map((path) => path.slice(2))
      .join(" "),
  ).toBe(expected);
}

test("children stand in the order in which they run, those that nothing leads to last", () => {
  check(
    `
    R hierarchy outcome done
      A "Last" execution outcome ok
      B "Repair" execution outcome ok
      C "First" execution outcome ok outcome lost
      D "Alone" execution outcome ok
      R > C
      C.ok > A
      C.lost > B
      B.ok > C
      A.ok > R.done`,
    "C A B D",
  );
});

test("a concurrency has no order but its own, with the decider last", () => {
  check(
    `
    R barrier outcome done
      unique_decider_state_id decider outcome success
      B execution outcome ok
      A execution outcome ok`,
    "B A unique_decider_state_id",
  );
});
