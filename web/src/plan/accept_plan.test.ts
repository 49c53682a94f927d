import { expect, test } from "vitest";
import type { Selection } from "../model/generated/protocol.ts";
import { sketch } from "../model/testing/sketch.ts";
import { acceptPlan } from "./accept_plan.ts";
import { drawn, lines, reason } from "./testing/plans.ts";

const ANSWER: Selection = {
  container: "",
  states: sketch(`
    P "Errand" hierarchy 0 0 200 100 outcome success
      A "Drive" execution 20 20 60 60 outcome success
      P > A
      A.success > P.success
  `).states,
};

/** The edits, without the places that are checked elsewhere and with the fresh id named. */
function accepted(machine: Parameters<typeof acceptPlan>[0], container: string) {
  const planned = acceptPlan(machine, container, ANSWER);
  if ("refused" in planned) throw new Error(planned.refused);
  const id = planned.path.split("/").at(-1) ?? "";
  const words = lines(planned).map((line) =>
    line.replaceAll(id, "NEW").replace(/selection=.*ids/, "ids"),
  );
  return { ...planned, words };
}

test("in an empty hierarchy the plan is the whole way", () => {
  const { name, words, states } = accepted(
    drawn('R "Root" hierarchy 0 0 1000 1000 outcome done'),
    "R",
  );
  expect(name).toBe("Accept plan Errand");
  expect(words).toEqual([
    'paste R ids=["NEW"]',
    'set_start R to={"state":"NEW"}',
    'add_transition R transition=0 from={"state":"NEW","outcome":0} to={"outcome":0}',
  ]);
  expect(states.map(({ path }) => path)).toEqual(["P", "P/A"]);
});

test("beside others it stands in a free place, under a name of its own", () => {
  const machine = drawn(`
    R "Root" hierarchy 0 0 1000 1000 outcome done
      E "Errand" execution 0 0 900 400 outcome ok
      R > E
  `);
  const { name, words } = accepted(machine, "R");
  expect(name).toBe("Accept plan Errand 2");
  expect(words).toEqual(['paste R ids=["NEW"]']);
});

test("what takes no states is refused", () => {
  const machine = drawn('R "Root" execution outcome done');
  expect(reason(acceptPlan(machine, "R", ANSWER))).toMatch(/Root/);
  const empty = acceptPlan(drawn('R "Root" hierarchy'), "R", { container: "" });
  expect(reason(empty)).toBe("The plan has no state: plan again.");
});
