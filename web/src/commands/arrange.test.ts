import { expect, test, vi } from "vitest";
import type { Layouter } from "../plan/arrange.ts";
import { allCommands } from "./all.ts";
import { layOut } from "./layouter.ts";
import { testContext } from "./testing/context.ts";

vi.mock("./layouter.ts", () => ({
  layOut: vi.fn<Layouter>((graph) => Promise.resolve(graph)),
  abandonLayout: vi.fn(),
}));

const MACHINE = `
  R hierarchy outcome done
    A hierarchy outcome ok
      B execution outcome ok
      C execution outcome ok
    D execution outcome ok`;

/** Each level that is laid out with this selected, by the states in it. */
async function laidOut(command: string, ...selected: readonly string[]): Promise<string> {
  vi.mocked(layOut).mockClear();
  const keys = selected.map((path) => `state:${path}` as const);
  const context = testContext(MACHINE, { selected: keys });
  await allCommands().find(`arrange.${command}`)?.run(context, undefined);
  const levels = vi.mocked(layOut).mock.calls.map(([graph]) => graph.children ?? []);
  return levels.map((children) => children.map(({ id }) => id).join(" ")).join(", ");
}

test("this level is the one that one looks at: what is selected is laid out among its neighbours", async () => {
  expect(await laidOut("layout-level", "R/A")).toBe("A D");
  expect(await laidOut("layout-level", "R/A/B")).toBe("B C");
  expect(await laidOut("layout-level", "R")).toBe("A D");
  expect(await laidOut("layout-level")).toBe("A D");
});

test("all levels inside are those of the selected container", async () => {
  expect(await laidOut("layout-all", "R/A")).toBe("B C");
  expect(await laidOut("layout-all", "R/D")).toBe("B C, A D");
});
