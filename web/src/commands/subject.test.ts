import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import { PlainMachineSession } from "../canvas/testing/driver.ts";
import { elementOf } from "../model/element.ts";
import { newView, select } from "../store/page/view.ts";
import type { CommandContext } from "./command.ts";
import { libraryAround, whyNot } from "./subject.ts";
import { testContext } from "./testing/context.ts";

const MACHINE = `
  R hierarchy 0 0 400 300 outcome done
    A execution 20 20 80 60 outcome ok
    L "Grasp" library 220 20 80 60 outcome ok library=arm/grasp
`;
const CONTENT = `
  G hierarchy 0 0 100 100 outcome ok
    M "Approach" execution 10 10 30 30 outcome ok
`;

function chosen(key: string): CommandContext {
  const view = newView();
  const element = elementOf(key);
  select(view, element ? [element] : []);
  return {
    ...testContext(MACHINE),
    tab: { session: new PlainMachineSession(MACHINE, CONTENT), view, run: signal(null) },
  };
}

test("what lies in a library leads to that library", () => {
  expect(libraryAround(chosen("state:R/L"))?.name).toBe("Grasp");
  expect(libraryAround(chosen("state:R/L/G/M"))?.name).toBe("Grasp");
  expect(libraryAround(chosen("state:R/A"))).toBe(null);
});

test("what lies in a library says why it does not change", () => {
  expect(whyNot(chosen("state:R/L/G/M"))).toContain("Approach belongs to a library");
  expect(whyNot(chosen("transition:R/L/G:1"))).toContain("library");
  expect(whyNot(chosen("state:R/L"))).toBe(null);
});
