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

test("of more than a thousand notices the oldest goes, closed or not", () => {
  const all = Array.from({ length: 1_001 }, (_, at) => warning(`${at + 1}`));
  check(told(...all.slice(0, 1_000)).slice(0, 1), ["1 1"]);
  const kept = told(...all);
  expect(kept.length).toBe(1_000);
  check([...kept.slice(0, 1), ...kept.slice(-1)], ["2 2", "1001 1001"]);
});

test("a notice counts with an equal one of the last twenty, and not with one before them", () => {
  const others = (count: number) => Array.from({ length: count }, (_, at) => warning(`${at}`));
  check(told(warning("a"), ...others(19), warning("a")).slice(-1), ["21 a (2 times)"]);
  const apart = told(warning("a"), ...others(20), warning("a"));
  check([...apart.slice(0, 1), ...apart.slice(-1)], ["1 a", "22 a"]);
});
