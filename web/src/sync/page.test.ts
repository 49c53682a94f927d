import { afterEach, describe, expect, it } from "vitest";
import type { RunSummary, ServerStatus } from "../model/generated/protocol.ts";
import { sketch } from "../model/testing/sketch.ts";
import { openDrafts } from "../store/document/drafts.ts";
import { localStoreOf, memoryStore, storageFault } from "../store/local_store.ts";
import { type Follower, RefusalError } from "../store/page/server.ts";
import { FIRST_SETTINGS } from "../store/page/settings.ts";
import { select } from "../store/page/view.ts";
import { twoTabs } from "../store/testing/two_tabs.ts";
import { startPage } from "./page.ts";
import { FakeClock } from "./testing/fake_clock.ts";
import { FakeServer, MACHINE } from "./testing/fake_server.ts";

const FILE = { project: "p", path: "machine" };
const RUN = { id: "r", machine: FILE, started_ms: 1, phase: "finished" } as unknown as RunSummary;
const HOUSE: ServerStatus = { files_revision: 1, machines: [MACHINE], runs: [] };

function setUp(
  stores = { own: memoryStore(), shared: memoryStore() },
  runs: readonly RunSummary[] = [],
) {
  const server = new FakeServer(sketch("R hierarchy\n  A execution"));
  server.runs = runs;
  const followers: Follower[] = [];
  const { follow } = server;
  server.follow = (follower) => {
    followers.push(follower);
    return follow(follower);
  };
  const clock = new FakeClock();
  const page = startPage({ server, clock, stores });
  const tellStatus = (status: ServerStatus) => {
    const follower = followers.find((each) => each.topic().topic === "server_status");
    follower?.frame({ frame: "server_status", subscription: 1, status });
  };
  const asked = (path: string) => server.asked.filter((each) => each === `GET ${path}`).length;
  return { server, page, clock, stores, tellStatus, asked };
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 50; turn += 1) await Promise.resolve();
}

/** A storage that reads as empty and refuses what is put there. */
function refusingStore(name: string) {
  const setItem = () => {
    throw new DOMException("no", name);
  };
  const storage = { getItem: () => null, setItem } as unknown as Storage;
  return { ...localStoreOf(() => storage, ""), whenOther: () => {} };
}

describe("the page", () => {
  afterEach(() => {
    storageFault.value = null;
  });

  it.each([
    ["QuotaExceededError", "The browser's storage for this page is full."],
    ["SecurityError", "The browser does not let this page store anything."],
  ])("says once what a browser does not keep, and goes on with it: %s", (name, reason) => {
    const store = refusingStore(name);
    const { page } = setUp({ own: store, shared: store });
    expect(page.notices.value).toEqual([]);
    page.settings.value = { ...page.settings.value, theme: "dark" };
    page.settings.value = { ...page.settings.value, wheel: "pan" };
    const drafts = openDrafts(store);
    const draft = { machine: "m", path: "R", field: "script", text: "new", base: "" } as const;
    drafts.keep(draft);
    expect(page.settings.value).toMatchObject({ theme: "dark", wheel: "pan" });
    expect(drafts.get(draft)?.text).toBe("new");
    const lost = /you lose changed settings, scripts and descriptions that are not applied/;
    const shown = page.notices.value.map(({ text, count }) => [
      text.split(". ")[0],
      lost.test(text),
      count,
    ]);
    expect(shown).toEqual([[reason.slice(0, -1), true, 1]]);
  });

  it("keeps one notice on each passing topic", () => {
    const { page } = setUp();
    const passing = { topic: "failures", machine: "m" };
    page.tell({ level: "error", text: "1 failure", passing });
    page.tell({ level: "info", text: "saved" });
    page.tell({ level: "error", text: "2 failures", passing });
    page.tell({ level: "error", text: "a crash", passing: { ...passing, topic: "crash" } });
    const texts = page.notices.value.map(({ text }) => text);
    expect(texts).toEqual(["saved", "2 failures", "a crash"]);
  });

  it("takes it that projects and libraries cannot be asked for, and asks again", async () => {
    const { server, tellStatus, asked } = setUp();
    const { request } = server;
    const message = "the server does not respond";
    server.request = async (method, path) => {
      await request(method, path);
      throw new RefusalError({ code: "no_answer", message }, 0);
    };
    tellStatus(HOUSE);
    await settle();
    tellStatus({ ...HOUSE });
    await settle();
    expect([asked("/projects"), asked("/libraries")]).toEqual([2, 2]);
  });

  it("opens a machine once, and remembers its folder", async () => {
    const { server, page } = setUp();
    const [one, other] = await Promise.all([page.open(FILE), page.open(FILE)]);
    expect(one).toBe(other);
    expect(page.tabs.value).toEqual([one]);
    expect(page.active.value).toBe(one);
    expect(page.settings.value.recent).toEqual([FILE]);
    expect(server.asked).toContain("GET /machines/m/document");
  });

  it("takes a tab away, and shows the next one", async () => {
    const { page } = setUp();
    const tab = await page.open(FILE);
    page.leave(tab);
    page.leave(tab);
    expect([page.tabs.value, page.active.value]).toEqual([[], null]);
  });

  it("keeps what another tab of the browser has set meanwhile", async () => {
    const [one, two] = twoTabs();
    const here = setUp({ own: memoryStore(), shared: one }).page;
    const other = setUp({ own: memoryStore(), shared: two }).page;
    other.settings.value = { ...other.settings.value, theme: "light" };
    expect(here.settings.value.theme).toBe("light");
    await here.open(FILE);
    expect(other.settings.value).toEqual({
      ...FIRST_SETTINGS,
      theme: "light",
      recent: [FILE],
    });
  });

  it("comes back as it was", async () => {
    const { page, clock, stores } = setUp();
    const tab = await page.open(FILE);
    await settle();
    select(tab.view, [{ kind: "state", path: "R/A" }]);
    tab.view.camera.value = { x: 1, y: 2, scale: 3 };
    clock.pass(1_000);
    const again = setUp({ own: memoryStore(), shared: stores.shared }).page;
    expect(again.isRestoring.value).toBe(true);
    await settle();
    expect(again.isRestoring.value).toBe(false);
    const view = again.active.value?.view;
    expect([...(view?.selection.value ?? [])]).toEqual(["state:R/A"]);
    expect(view?.camera.value).toEqual({ x: 1, y: 2, scale: 3 });
  });

  it("shows the machine as it ran once, however often that is wanted", async () => {
    const { server, page } = setUp();
    server.runs = [RUN];
    const [one, other] = await Promise.all([page.showAsRan("r"), page.showAsRan("r")]);
    expect(one).toBe(other);
    expect(page.tabs.value).toEqual([one]);
  });

  it("shows a run that it was not told of yet in the tab of its machine", async () => {
    const { server, page } = setUp();
    const tab = await page.open(FILE);
    await settle();
    server.runs = [RUN];
    expect(await page.showRun("r")).toBe(tab);
    expect(tab.run.value?.id).toBe("r");
  });

  it("says which run is on its way until it is there, or cannot be shown", async () => {
    const { server, page } = setUp();
    server.runs = [RUN];
    await page.runs.refresh();
    const shown = page.showRun("r");
    expect(page.comingRun.value).toBe("r");
    await shown;
    expect(page.comingRun.value).toBeNull();
    server.request = () => Promise.reject(new RefusalError({ code: "gone", message: "gone" }, 404));
    const refused = page.showRun("other").catch((error: Error) => error.message);
    expect(page.comingRun.value).toBe("other");
    expect(await refused).toBe("gone");
    expect(page.comingRun.value).toBeNull();
  });

  it("comes back with the runs that it showed, but for those that were deleted since", async () => {
    const { server, page, clock, stores } = setUp();
    server.runs = [RUN];
    await page.runs.refresh();
    await page.open(FILE);
    await settle();
    await page.showRun("r");
    const ran = await page.showAsRan("r");
    await page.open(FILE);
    clock.pass(1_000);
    expect(page.active.value).not.toBe(ran);
    const again = setUp({ own: memoryStore(), shared: stores.shared }, [RUN]).page;
    await settle();
    expect(again.tabs.value.map(({ run }) => run.value?.id)).toEqual(["r", "r"]);
    expect(again.tabs.value.map(({ session }) => session.fixed !== null)).toEqual([false, true]);
    expect(again.active.value).toBe(again.tabs.value[0]);
    const later = setUp({ own: memoryStore(), shared: stores.shared }).page;
    await settle();
    expect(later.tabs.value.map(({ run }) => run.value)).toEqual([null]);
  });

  it("remembers a machine as soon as it is open", async () => {
    const { page, stores } = setUp();
    await settle();
    await page.open(FILE);
    expect(setUp(stores).page.isRestoring.value).toBe(true);
  });

  it("asks for projects and libraries when files have changed, and only then", async () => {
    const { tellStatus, asked } = setUp();
    tellStatus(HOUSE);
    tellStatus({ ...HOUSE, machines: [] });
    await settle();
    expect([asked("/projects"), asked("/libraries")]).toEqual([1, 1]);
    tellStatus({ ...HOUSE, files_revision: 2 });
    await settle();
    expect([asked("/projects"), asked("/libraries")]).toEqual([2, 2]);
  });

  it("says when the connection is back after a break that people noticed", () => {
    const { server, page, clock } = setUp();
    const up = server.link.value;
    const broken = (length_ms: number) => {
      const since_ms = clock.now();
      server.link.value = { state: "down", since_ms, retry_ms: null, reason: "gone" };
      clock.pass(length_ms);
      server.link.value = up;
    };
    broken(500);
    broken(7_000);
    expect(page.notices.value.map(({ text }) => text)).toEqual(["Reconnected after 7 s"]);
  });

  it("takes a wait for a login for no break", () => {
    const { server, page, clock } = setUp();
    const up = server.link.value;
    const since_ms = clock.now();
    server.link.value = { state: "down", since_ms, retry_ms: null, reason: "gone" };
    server.link.value = { state: "refused", reason: "the server requires a login" };
    clock.pass(9_000);
    server.link.value = { state: "connecting" };
    server.link.value = up;
    expect(page.notices.value).toEqual([]);
  });

  it("says when the server is of another version than the page", () => {
    const { server, page } = setUp();
    const up = server.link.value;
    server.link.value = { state: "connecting" };
    if (up.state === "up") {
      server.link.value = { ...up, session: { ...up.session, version: "1" } };
    }
    expect(page.notices.value.map(({ text }) => text)).toEqual([
      "The server now has version 1, but this page has version 0. Reload the page.",
    ]);
  });

  it("forgets what is selected when it is gone", async () => {
    const { server, page } = setUp();
    const tab = await page.open(FILE);
    select(tab.view, [{ kind: "state", path: "R/A" }]);
    server.make("x", { edit: "remove_state", path: "R", state: "A" });
    server.tell(1);
    expect(tab.view.selection.value.size).toBe(0);
  });
});

describe("a page that is loaded again", () => {
  it("has the machine in front at once, and none of the others comes to the front", async () => {
    const files = ["a", "b", "c"].map((path) => ({ project: "p", path }));
    const before = setUp();
    before.server.hasMany = true;
    for (const file of files) await before.page.open(file);
    before.page.active.value = before.page.tabs.value[1] ?? null;
    before.clock.pass(1_000);
    const again = setUp({ own: before.stores.own, shared: before.stores.shared });
    again.server.hasMany = true;
    const fronts: string[] = [];
    again.page.active.subscribe((tab) => tab && fronts.push(tab.session.id));
    await settle();
    await settle();
    expect(fronts).toEqual(["b"]);
    expect(again.page.tabs.value.map(({ session }) => session.id)).toEqual(["a", "b", "c"]);
  });
});
