import { expect, test, vi } from "vitest";
import type { Layouter } from "../plan/arrange.ts";
import { cancelLayout, layoutOf, layoutWork } from "./layout_work.ts";
import { abandonLayout, layOut } from "./layouter.ts";
import { testContext } from "./testing/context.ts";

vi.mock("./layouter.ts", () => ({ layOut: vi.fn<Layouter>(), abandonLayout: vi.fn() }));

const MACHINE = `
  R hierarchy outcome done
    A hierarchy outcome ok
      B execution outcome ok
      C execution outcome ok
    D execution outcome ok`;

/** Layouts that are answered one by one, or fail together once they are abandoned. */
function engine() {
  const open: { readonly finish: () => void; readonly fail: () => void }[] = [];
  vi.mocked(layOut).mockImplementation(
    (graph) =>
      new Promise((resolve, reject) => {
        open.push({ finish: () => resolve(graph), fail: () => reject(new Error("abandoned")) });
      }),
  );
  vi.mocked(abandonLayout).mockImplementation(() => {
    for (const each of open.splice(0)) each.fail();
  });
  return { open, begun: (count: number) => vi.waitFor(() => expect(open).toHaveLength(count)) };
}

test("a layout reports how many levels are done", async () => {
  const { open, begun } = engine();
  const { tab } = testContext(MACHINE);
  const levels = layoutOf(tab, tab.session.machine, "R", true);
  await begun(1);
  expect(layoutWork.value).toMatchObject({ states: 4, levelsDone: 0, levels: 2 });
  open[0]?.finish();
  await begun(2);
  expect(layoutWork.value).toMatchObject({ levelsDone: 1, levels: 2 });
  open[1]?.finish();
  expect([...((await levels)?.keys() ?? [])]).toEqual(["R/A", "R"]);
  expect(layoutWork.value).toBe(null);
});

test("a cancelled layout ends at once and is not computed in another way", async () => {
  const { open, begun } = engine();
  const { tab } = testContext(MACHINE);
  const levels = layoutOf(tab, tab.session.machine, "R", true);
  await begun(1);
  cancelLayout();
  expect(await levels).toBe(null);
  expect([open.length, layoutWork.value]).toEqual([0, null]);
});

test("another layout cancels the first", async () => {
  const { open, begun } = engine();
  const { tab } = testContext(MACHINE);
  const first = layoutOf(tab, tab.session.machine, "R", true);
  await begun(1);
  const second = layoutOf(tab, tab.session.machine, "R/A", false);
  expect(await first).toBe(null);
  await begun(1);
  open[0]?.finish();
  expect([...((await second)?.keys() ?? [])]).toEqual(["R/A"]);
});
