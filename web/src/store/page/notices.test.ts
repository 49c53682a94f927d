import { expect, test } from "vitest";
import { noticeText, openNotices, type Telling, withNotice } from "./notices.ts";
import type { Notice } from "./page.ts";

function told(...tellings: readonly Telling[]): readonly Notice[] {
  return tellings.reduce<readonly Notice[]>(
    (before, telling, at) => withNotice(before, telling, at + 1, at),
    [],
  );
}

const warning = (text: string): Telling => ({ level: "warning", text });

function check(notices: readonly Notice[], expected: readonly string[]): void {
  expect(notices.map((notice) => `${notice.id} ${noticeText(notice)}`)).toEqual(expected);
}

test("equal notices are one that counts, with the newest's place", () => {
  const refusals = Array.from({ length: 169 }, () => warning("Group was not done"));
  check(told(warning("other"), ...refusals), ["1 other", "170 Group was not done (169 times)"]);
});

test("another level, action or place is another notice", () => {
  const action = { title: "Look", command: "mission.show" };
  const about = { machine: "m", element: { kind: "state", path: "R" } } as const;
  const notices = told(
    warning("a"),
    { level: "error", text: "a" },
    { ...warning("a"), action },
    { ...warning("a"), about },
  );
  expect(notices.length).toBe(4);
});

test("news of a topic takes the place of the one before", () => {
  const passing = { topic: "failures", machine: "m" };
  check(told({ ...warning("1 failure"), passing }, { ...warning("2 failures"), passing }), [
    "2 2 failures",
  ]);
});

test("what was not closed stays to be had, the newest first, a hundred at most", () => {
  const notices = told(...Array.from({ length: 150 }, (_, at) => warning(`${at + 1}`)), {
    level: "info",
    text: "quiet",
    isQuiet: true,
  });
  const open = openNotices(notices, new Set([150]));
  expect(open.length).toBe(100);
  check(open.slice(0, 2), ["149 149", "148 148"]);
});
