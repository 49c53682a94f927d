// @vitest-environment happy-dom
import { computed, signal } from "@preact/signals-core";
import { act } from "react";
import { afterEach, expect, test, vi } from "vitest";
import { allCommands } from "../commands/all.ts";
import { layoutOf } from "../commands/layout_work.ts";
import { abandonLayout, layOut } from "../commands/layouter.ts";
import { type TestContext, testContext } from "../commands/testing/context.ts";
import type { Layouter } from "../plan/arrange.ts";
import type { LayoutProposal, ProposedEdit } from "../store/document/machine_session.ts";
import { click, mount, press, unmount } from "../ui/testing/mounted.tsx";
import { LayoutWorkBar, ProposedLayoutBar } from "./layout_bars.tsx";
import { newSession } from "./session.ts";
import { SessionProvider } from "./session_context.tsx";

vi.mock("../commands/layouter.ts", () => ({ layOut: vi.fn<Layouter>(), abandonLayout: vi.fn() }));

afterEach(unmount);

function shown({ page, tab }: TestContext): HTMLElement {
  const session = newSession({ ...page, active: signal(tab) }, allCommands());
  return mount(
    <SessionProvider value={session}>
      <LayoutWorkBar tab={tab} />
      <ProposedLayoutBar tab={tab} />
    </SessionProvider>,
  );
}

const states = (count: number) =>
  Array.from({ length: count }, (_, index) => `  S${index} execution outcome ok`);

/** An engine that answers nothing until it is abandoned. */
function silent(): void {
  let fail: () => void = () => {};
  vi.mocked(layOut).mockImplementation(
    () =>
      new Promise((_, reject) => {
        fail = () => reject(new Error("abandoned"));
      }),
  );
  vi.mocked(abandonLayout).mockImplementation(() => fail());
}

test("the bar of a long layout says how far it is, and Escape cancels it", async () => {
  silent();
  const context = testContext(["R hierarchy", ...states(60)].join("\n"));
  const place = shown(context);
  const levels = layoutOf(context.tab, context.tab.session.machine, "R", false);
  await vi.waitFor(() => expect(layOut).toHaveBeenCalled());
  await act(async () => {});
  expect(place.textContent).toContain(
    "Automatic layout of 60 states is in progress: 0 of 1 levels are done.",
  );
  press(document.body, "Escape");
  expect(await levels).toBe(null);
  await act(async () => {});
  expect(place.textContent).toBe("");
});

function undrawn() {
  const context = testContext(["R hierarchy", ...states(3)].join("\n"));
  const proposed = signal<ProposedEdit | null>(null);
  const keep = vi.fn(async () => {});
  const proposal: LayoutProposal = {
    shown: proposed,
    isDue: computed(() => proposed.value === null),
    show: (edit) => {
      proposed.value = edit;
    },
    keep,
  };
  return { context, proposed, proposal, keep };
}

test("a machine without a layout is arranged when it opens, and the bar keeps that", async () => {
  vi.mocked(layOut).mockImplementation((graph) => Promise.resolve(graph));
  const { context, proposed, proposal, keep } = undrawn();
  const place = shown({
    ...context,
    tab: { ...context.tab, session: { ...context.tab.session, proposal } },
  });
  await vi.waitFor(() => expect(proposed.value?.name).toBe("Automatic layout"));
  await act(async () => {});
  expect(place.textContent).toContain("This machine has no layout");
  expect(context.record).toEqual([]);
  click(place.querySelector("button"));
  expect(keep).toHaveBeenCalled();
});

test("a machine that changes while its layout is computed is arranged as it is then", async () => {
  const { context, proposed, proposal } = undrawn();
  const machine = { ...context.tab.session.machine, version: 1 };
  vi.mocked(layOut).mockReset();
  vi.mocked(layOut).mockImplementation((graph) => {
    machine.version = 2;
    return Promise.resolve(graph);
  });
  shown({
    ...context,
    tab: { ...context.tab, session: { ...context.tab.session, machine, proposal } },
  });
  await vi.waitFor(() => expect(proposed.value).not.toBe(null));
  expect(layOut).toHaveBeenCalledTimes(2);
});
