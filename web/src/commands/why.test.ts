import { expect, test } from "vitest";
import type { ElementKey } from "../model/element.ts";
import { allCommands } from "./all.ts";
import { refusalOf } from "./command.ts";
import { testContext } from "./testing/context.ts";
import { whyDisabled } from "./why.ts";

const MACHINE = `
  R hierarchy 0 0 400 300 outcome done
    A execution 20 20 80 60 outcome ok
    L "Grasp" library 220 20 80 60 outcome ok library=arm/grasp
`;

const chosen = (key: ElementKey | "") =>
  testContext(MACHINE, { selected: key === "" ? [] : [key] });

const why = (id: string, key: ElementKey | "") => {
  const command = allCommands().find(id);
  return command ? whyDisabled(command, chosen(key)) : "there is no such command";
};

test("a command that cannot be done says what it needs", () => {
  expect(why("arrange.substitute", "state:R")).toBe(
    "select a state inside the machine, not the machine itself",
  );
  expect(why("arrange.group", "outcome:R/A:0")).toBe("select states of one container");
  expect(why("arrange.ungroup", "state:R/A")).toBe(
    "select one hierarchy or concurrency inside the machine",
  );
  expect(why("edit.delete", "")).toBe("select something first");
});

test("every command with a key says why it cannot be done, whatever is selected", () => {
  for (const key of ["", "state:R", "state:R/A", "state:R/L", "outcome:R/A:0"] as const) {
    const context = chosen(key);
    const silent = allCommands()
      .all()
      .filter((command) => command.keys && refusalOf(command, context) === "")
      .filter((command) => whyDisabled(command, context) === null);
    expect([key, ...silent.map(({ id }) => id)]).toEqual([key]);
  }
});
