/** What the page knows of a run beside what the server has of it, event for event. */

import { expect, vi } from "vitest";
import type { EventPage, RunSummary, StartRun } from "../../src/model/generated/protocol.ts";
import type { App } from "./app.ts";
import { endRun } from "./mission.ts";
import { PATIENCE } from "./patience.ts";
import { exampleWith } from "./runs.ts";
import type { Server } from "./server.ts";

/** The packer, which picks parts without end, about ten a second. */
export const PACKER = exampleWith("hierarchy_and_data", {
  "Pack_one_part_ONEPAR/Pick_from_the_belt_PICKIT/script.py": [
    "def execute(self, inputs, outputs, gvm):",
    '    print("part", inputs["number"])',
    "    if self.preemptive_wait(0.05):",
    '        return "preempted"',
    '    outputs["part_g"] = 120.0',
    '    return "success"',
    "",
  ].join("\n"),
});

/** Starts a machine of the project and shows the run. */
export async function startAndShow(
  app: App,
  server: Server,
  path: string,
  more: Partial<StartRun> = {},
): Promise<string> {
  const [project] = await server.ask<readonly { readonly id: string }[]>("GET", "/projects");
  const start = { id: `run-${Date.now()}`, machine: { project: project?.id, path }, ...more };
  const run = await server.ask<RunSummary>("POST", "/runs", start);
  await app.sheet.evaluate(async (id) => {
    await window.__rafcon.page.showRun(id);
  }, run.id);
  return run.id;
}

/** Waits until the page has been told so many events more than now. */
export async function goesOn(app: App, events = 10): Promise<void> {
  const before = await receivedCount(app);
  await vi.waitUntil(async () => (await receivedCount(app)) >= before + events, PATIENCE);
}

async function receivedCount(app: App): Promise<number> {
  return app.sheet.evaluate(
    () => window.__rafcon.page.active.value?.run.value?.journal.length ?? 0,
  );
}

/** Waits until the newest snapshot that the page has says this. The first one comes later than the first events. */
export async function statusIs(app: App, status: string): Promise<void> {
  await app.until(
    ({ tab }, wanted) => tab?.run.value?.now.value?.snapshot?.status === wanted,
    status,
  );
}

/** Waits until the page's connection is so. */
export async function linkIs(app: App, state: "up" | "down"): Promise<void> {
  await vi.waitUntil(
    async () =>
      (await app.sheet.evaluate(() => window.__rafcon.page.server.link.value.state)) === state,
    PATIENCE,
  );
}

/** Waits until the page knows that it has been without connection for so long. */
export async function untilDownFor(app: App, ms: number): Promise<void> {
  const look = () =>
    app.sheet.evaluate((wanted) => {
      const link = window.__rafcon.page.server.link.value;
      return link.state === "down" && Date.now() - link.since_ms >= wanted;
    }, ms);
  await vi.waitUntil(look, { ...PATIENCE, timeout: PATIENCE.timeout + ms });
}

/** Ends the run, and says that the page then has all its events, each once. */
export async function endsWhole(app: App, server: Server, run: string): Promise<void> {
  await endRun(server, run);
  await vi.waitUntil(
    () =>
      app.sheet.evaluate(() => {
        const watch = window.__rafcon.page.active.value?.run.value;
        return watch?.now.value?.run.phase === "finished" && watch.isCaughtUp.value;
      }),
    PATIENCE,
  );
  const there = await eventsOf(server, run);
  await vi.waitUntil(async () => (await receivedCount(app)) >= there.length, PATIENCE);
  expect(await eventsIn(app)).toEqual(there);
  expect(there.length).toBeGreaterThan(20);
}

/** All events of a run as the server has them. */
async function eventsOf(server: Server, run: string): Promise<readonly string[]> {
  const found: string[] = [];
  for (let next = 1; ; ) {
    const route = `/runs/${run}/events?from=${next}&count=1000&values=false`;
    const page = await server.ask<EventPage>("GET", route);
    for (const { sequence, t_ns, event } of page.events) {
      const isStep = event.type === "entered" || event.type === "left";
      const about = isStep ? `${event.path} ${"outcome" in event ? event.outcome.name : ""}` : "";
      found.push(`${sequence} ${t_ns} ${event.type} ${about}`.trimEnd());
    }
    next = page.next;
    if (page.next > page.last) return found;
  }
}

/** The same as the page has them, from its columns. */
async function eventsIn(app: App): Promise<readonly string[]> {
  return app.sheet.evaluate(() => {
    const journal = window.__rafcon.page.active.value?.run.value?.journal;
    return Array.from({ length: journal?.length ?? 0 }, (_, index) => {
      const found = journal?.at(index);
      if (!found) return "gone";
      const { sequence, t_ns } = found;
      if (found.kind === "other") return `${sequence} ${t_ns} ${found.event.type}`;
      return `${sequence} ${t_ns} ${found.kind} ${found.path} ${found.outcome?.name ?? ""}`.trimEnd();
    });
  });
}

/** What has the colour of what runs, in panels and buttons: by its class and text. The state of the link to the server is not the
 * robot's. */
export async function looksAlive(app: App): Promise<readonly string[]> {
  return app.sheet.evaluate(() => {
    const probe = document.createElement("i");
    probe.style.color = "var(--running)";
    document.body.append(probe);
    const live = getComputedStyle(probe).color;
    probe.remove();
    return [...document.querySelectorAll("body *")].flatMap((part) => {
      const { color, backgroundColor, borderTopColor, fill, stroke } = getComputedStyle(part);
      const has = [color, backgroundColor, borderTopColor, fill, stroke].includes(live);
      const { width, height } = part.getBoundingClientRect();
      const isSeen = width > 1 && height > 1 && !part.closest(".link");
      return has && isSeen ? [`${part.getAttribute("class")}: ${part.textContent}`] : [];
    });
  });
}
