// @vitest-environment happy-dom
import { signal } from "@preact/signals-core";
import { afterEach, expect, test, vi } from "vitest";
import type { KeptAs, LinkHealth, ValueFetch } from "../../../model/generated/protocol.ts";
import type { Watch } from "../../../store/history/run.ts";
import type { Page } from "../../../store/page/page.ts";
import { mount, settled, unmount } from "../../../ui/testing/mounted.tsx";
import { OnRobotValue } from "./on_robot.tsx";

afterEach(() => {
  unmount();
  vi.useRealTimers();
});

const THERE = {
  kept: "on_robot",
  bytes: 2_000_000,
  link_bytes: 2_200_000,
  takes_ms: 70_000,
} as const;

/** A station whose value is as a test says. */
function station(rights: readonly string[] = ["observe", "command"]) {
  let fetch: ValueFetch | null = null;
  let here: KeptAs | null = null;
  const asked: string[] = [];
  const value = () => ({
    number: 7,
    type_name: "ndarray",
    view: "…",
    ...(here ?? { ...THERE, fetch }),
  });
  const get = async (_: string, what: string) =>
    what.startsWith("events/")
      ? { sequence: 5, values: [{ name: "cloud", value: value() }] }
      : value();
  const fetchValue = async (_: string, number: number, isWanted: boolean) => {
    asked.push(`${isWanted ? "fetch" : "cancel"} ${number}`);
    fetch = isWanted ? { here: 0, budget: 2_500_000, failed: null } : null;
    return value();
  };
  const link = signal({ state: "up", session: { user: "ana", rights } });
  const page = { runs: { get, fetchValue }, server: { link } } as unknown as Page;
  const is = (now: { fetch?: ValueFetch; here?: KeptAs }) => {
    fetch = now.fetch ?? null;
    here = now.here ?? null;
  };
  return { page, asked, is };
}

async function shown(page: Page, run: string, robot: Partial<LinkHealth> | null = null) {
  const watch = { id: run, now: signal({ robot }) } as unknown as Watch;
  const place = mount(<OnRobotValue page={page} watch={watch} sequence={5} name="cloud" />);
  await settled();
  await settled();
  const button = () => place.querySelector("button");
  return { words: () => place.textContent, button };
}

test("a value says what it costs before it is fetched, how far it is, and that it is here", async () => {
  vi.useFakeTimers({ toFake: ["setInterval", "clearInterval"] });
  const { page, asked, is } = station();
  const { words, button } = await shown(page, "fetched");
  expect(words()).toBe(
    "Shown in part: all 2.0 MB are on the robot. Fetching costs 2.2 MB of the link, about 1:10 at its rate now.Fetch all of it",
  );
  button()?.click();
  await settled();
  expect(asked).toEqual(["fetch 7"]);
  is({ fetch: { here: 500_000, budget: 2_000_000, failed: null } });
  vi.advanceTimersByTime(1_000);
  await settled();
  expect(words()).toContain("500 KB of 2.0 MB");
  expect(words()).toContain("about 53 s left");
  expect(button()?.textContent).toBe("Cancel");
  is({ fetch: { here: 600_000, budget: 0, failed: "its budget is used up" } });
  vi.advanceTimersByTime(1_000);
  await settled();
  expect(words()).toContain("Not fetched: its budget is used up.");
  expect(button()?.textContent).toBe("Fetch the rest");
  is({ here: { kept: "pickle", bytes: 2_000_000 } });
  vi.advanceTimersByTime(5_000);
  await settled();
  expect(words()).toBe("All 2.0 MB of cloud are here, and right by their hash.");
});

test("who may only look cannot fetch, and is told why", async () => {
  const { page } = station(["observe"]);
  const { button } = await shown(page, "looked at");
  expect(button()?.getAttribute("aria-disabled")).toBe("true");
  expect(button()?.title).toContain("ask an admin for the role operator");
});

test("a station whose pairing lets it only see runs cannot fetch, and is told why", async () => {
  const { page } = station();
  const { button } = await shown(page, "seen", { robot: "scout", rights: "observe" });
  expect(button()?.getAttribute("aria-disabled")).toBe("true");
  expect(button()?.title).toContain("rafcon pair scout --rights command");
});

test("a value that is here, or small, says nothing", async () => {
  const { page, is } = station();
  is({ here: { kept: "view" } });
  const { words } = await shown(page, "small");
  expect(words()).toBe("");
});
