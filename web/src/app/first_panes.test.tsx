// @vitest-environment happy-dom
import { signal } from "@preact/signals-core";
import { afterEach, expect, test } from "vitest";
import { testContext } from "../commands/testing/context.ts";
import { PanelHostProvider } from "../panels/context.tsx";
import { memoryStore } from "../store/local_store.ts";
import type { Page } from "../store/page/page.ts";
import { draw, settled, unmount } from "../ui/testing/mounted.tsx";
import { beginsWithMission, FirstPanesPort } from "./first_panes.tsx";
import { HostedParts, HostedPlace } from "./hosted.tsx";
import type { AppSession, DockPort } from "./session.ts";
import { SessionProvider } from "./session_context.tsx";
import { shown } from "./testing/shown.tsx";

afterEach(unmount);

test("what was wanted before the dock is loaded is done in the dock, in its order", () => {
  const port = new FirstPanesPort(false);
  port.layouts.apply("Mission control");
  port.showPanel("log");
  expect([port.isInSight("mission"), port.isInSight("log")]).toEqual([true, false]);
  const done: string[] = [];
  const dock = {
    showPanel: (panel: string) => done.push(`show ${panel}`),
    layouts: { apply: (name: string) => done.push(`apply ${name}`) },
  } as unknown as DockPort;
  port.handOver(dock);
  port.handOver(dock);
  expect(done).toEqual(["apply Mission control", "show log"]);
});

test("the page begins with mission control for operators, and as it was left", () => {
  const { page } = testContext("R hierarchy");
  const as = (role: string) =>
    ({
      ...page,
      server: { link: { value: { state: "up", session: { role } } } },
    }) as unknown as Page;
  const store = memoryStore();
  expect(beginsWithMission(as("operator"), store)).toBe(true);
  expect(beginsWithMission(as("engineer"), store)).toBe(false);
  store.put("rafcon.layout", { panels: { canvas: {}, mission: {} } });
  expect(beginsWithMission(as("engineer"), store)).toBe(true);
  store.put("rafcon.layout", { panels: { canvas: {} } });
  expect(beginsWithMission(as("operator"), store)).toBe(false);
});

test("mission control moves into the dock as it is", async () => {
  const parts = (session: AppSession, inDock: boolean) => (
    <SessionProvider value={session}>
      <PanelHostProvider value={{ commands: session.commands, context: session.context }}>
        {!inDock && (
          <div className="first">
            <HostedPlace id="mission" />
          </div>
        )}
        {inDock && (
          <div className="dock">
            <HostedPlace id="mission" />
          </div>
        )}
        <HostedParts />
      </PanelHostProvider>
    </SessionProvider>
  );
  const { session } = shown(() => <p />);
  Object.assign(session.page, { comingRun: signal(null) });
  draw(parts(session, false));
  await settled();
  const host = document.querySelector(".first .hosted");
  const content = host?.firstElementChild;
  expect(content).not.toBeNull();
  draw(parts(session, true));
  await settled();
  expect(document.querySelector(".dock .hosted")).toBe(host);
  expect(host?.firstElementChild).toBe(content);
});
