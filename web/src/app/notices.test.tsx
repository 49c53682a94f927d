// @vitest-environment happy-dom
import { signal } from "@preact/signals-core";
import { act } from "react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { allCommands } from "../commands/all.ts";
import { testContext } from "../commands/testing/context.ts";
import { PanelHostProvider } from "../panels/context.tsx";
import { putNotice, type Telling } from "../store/page/notices.ts";
import type { Notice, Page } from "../store/page/page.ts";
import { click, mount, press, unmount } from "../ui/testing/mounted.tsx";
import { NoticeBell } from "./notice_centre.tsx";
import { newSession } from "./session.ts";
import { SessionProvider } from "./session_context.tsx";
import { Toasts } from "./toasts.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

function shown() {
  const { page: plain } = testContext("R hierarchy");
  const notices = signal<readonly Notice[]>([]);
  const droppedNotices = signal(0);
  const page = { ...plain, notices, droppedNotices } as unknown as Page;
  const session = newSession(page, allCommands());
  const run: string[] = [];
  session.commands.call = ({ command, argument }) => {
    run.push(`${command} ${JSON.stringify(argument)}`);
    return true;
  };
  const place = mount(
    <SessionProvider value={session}>
      <PanelHostProvider value={{ commands: session.commands, context: session.context }}>
        <NoticeBell />
        <Toasts />
      </PanelHostProvider>
    </SessionProvider>,
  );
  let count = 0;
  const tell = (...tellings: readonly Telling[]) =>
    act(() => {
      for (const telling of tellings) {
        count += 1;
        putNotice(page, telling, count, count);
      }
    });
  const toasts = () => [...place.querySelectorAll(".toast-text")].map((each) => each.textContent);
  const button = (name: RegExp) =>
    [...place.querySelectorAll("button")].find((each) =>
      name.test(each.getAttribute("aria-label") ?? each.textContent ?? ""),
    ) ?? null;
  const centre = () => [...place.querySelectorAll(".notice-text")].map((each) => each.textContent);
  return { tell, toasts, button, centre, run, place };
}

const USE: Telling = {
  level: "info",
  text: "Saved as library arm/grasp.",
  action: { title: "Use it here", command: "arrange.substitute", argument: { path: "R/A" } },
};

test("equal refusals are one toast that counts, and none is left over for later", () => {
  const { tell, toasts } = shown();
  tell(...Array.from({ length: 169 }, () => ({ level: "warning" as const, text: "refused" })));
  expect(toasts()).toEqual(["refused (169 times)"]);
  act(() => void vi.advanceTimersByTime(11_000));
  expect(toasts()).toEqual([]);
});

test("what newer notices pushed away does not come back when they go", () => {
  const { tell, toasts } = shown();
  const all = Array.from({ length: 9 }, (_, at) => ({ level: "info" as const, text: `${at}` }));
  tell(...all);
  expect(toasts()).toEqual(["5", "6", "7", "8"]);
  act(() => void vi.advanceTimersByTime(6_000));
  expect(toasts()).toEqual([]);
});

test("an action is still to be had in the notice centre when its toast has gone", () => {
  const { tell, toasts, button, centre, run } = shown();
  tell(USE);
  act(() => void vi.advanceTimersByTime(60_000));
  expect(toasts()).toEqual([]);
  expect(button(/^Notices/)?.getAttribute("aria-label")).toBe("Notices: 1 new");
  click(button(/^Notices/));
  expect(centre()).toEqual(["Saved as library arm/grasp."]);
  click(button(/^Use it here$/));
  expect(run).toEqual(['arrange.substitute {"path":"R/A"}']);
  expect(centre()).toEqual([]);
});

test("all notices are closed at once, and Escape closes the notice centre", () => {
  const { tell, button, centre, place } = shown();
  tell(USE, { level: "error", text: "lost" });
  click(button(/^Notices/));
  expect(centre()).toEqual(["lost", "Saved as library arm/grasp."]);
  click(button(/^Close all$/));
  expect(centre()).toEqual([]);
  expect(button(/^Notices/)?.getAttribute("aria-label")).toBe("Notices");
  press(place.querySelector(".notice-centre"), "Escape");
  expect(place.querySelector(".notice-centre")).toBeNull();
});

test("a notice that was closed is new again when it is said again", () => {
  const { tell, button, centre } = shown();
  tell(USE);
  click(button(/^Close notice$/));
  tell(USE);
  click(button(/^Notices/));
  expect(centre()).toEqual(["Saved as library arm/grasp. (2 times)"]);
});

test("the notice centre says how many notices it does not list, and how many were dropped", () => {
  const { tell, button, place } = shown();
  const errors = (from: number, count: number): readonly Telling[] =>
    Array.from({ length: count }, (_, at) => ({ level: "error", text: `${from + at}` }));
  const more = () => place.querySelector(".notice-more")?.textContent ?? null;
  tell(...errors(1, 100));
  click(button(/^Notices/));
  expect(more()).toBeNull();
  tell(...errors(101, 900));
  expect(more()).toMatch(/^Not listed: 900 notices\. /);
  tell(...errors(1_001, 1));
  expect(more()).toMatch(/Dropped: 1 notice\. /);
  for (let turn = 0; turn < 10; turn += 1) click(button(/^Close all$/));
  expect(more()).toBeNull();
});
