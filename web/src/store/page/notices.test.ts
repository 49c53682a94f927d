import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import {
  closeNotices,
  type KeptNotices,
  noticeText,
  offeredNotices,
  openNotices,
  putNotice,
  type Telling,
} from "./notices.ts";
import type { Notice } from "./page.ts";

function keptOf(...tellings: readonly Telling[]): KeptNotices {
  const kept = { notices: signal<readonly Notice[]>([]), droppedNotices: signal(0) };
  tell(kept, ...tellings);
  return kept;
}

/** Numbers notices from one. */
function tell(kept: KeptNotices, ...tellings: readonly Telling[]): void {
  for (const telling of tellings) {
    const id = (kept.notices.value.at(-1)?.id ?? 0) + 1;
    putNotice(kept, telling, id, id);
  }
}

function noticesAfter(...tellings: readonly Telling[]): readonly Notice[] {
  return keptOf(...tellings).notices.value;
}

const warning = (text: string): Telling => ({ level: "warning", text });

function check(notices: readonly Notice[], expected: readonly string[]): void {
  expect(notices.map((notice) => `${notice.id} ${noticeText(notice)}`)).toEqual(expected);
}

test("equal notices are one that counts, with the newest's place", () => {
  const refusals = Array.from({ length: 169 }, () => warning("Group was not done"));
  check(noticesAfter(warning("other"), ...refusals), [
    "1 other",
    "170 Group was not done (169 times)",
  ]);
});

test("another level, action or place is another notice", () => {
  const action = { title: "Look", command: "mission.show" } as const;
  const about = { machine: "m", element: { kind: "state", path: "R" } } as const;
  const notices = noticesAfter(
    warning("a"),
    { level: "error", text: "a" },
    { ...warning("a"), action },
    { ...warning("a"), about },
  );
  expect(notices.length).toBe(4);
});

test("news of a topic takes the place of the one before", () => {
  const passing = { topic: "failures", machine: "m" };
  check(noticesAfter({ ...warning("1 failure"), passing }, { ...warning("2 failures"), passing }), [
    "2 2 failures",
  ]);
});

const many = (count: number, level: Notice["level"] = "warning"): readonly Telling[] =>
  Array.from({ length: count }, (_, at) => ({ level, text: `${at + 1}` }));

test("the notice centre has a hundred open notices at most, errors and actions before others", () => {
  const kept = keptOf(...many(150), { level: "info", text: "quiet", isQuiet: true });
  closeNotices(kept, kept.notices.value.slice(149, 150));
  const open = openNotices(kept.notices.value);
  expect(open.length).toBe(149);
  check(open.slice(0, 2), ["149 149", "148 148"]);
  const offered = offeredNotices(open);
  expect(offered.length).toBe(100);
  check(offered.slice(-1), ["50 50"]);
  const action = { title: "Look", command: "mission.show" } as const;
  const urgent = noticesAfter(
    { level: "error", text: "lost" },
    { ...warning("a"), action },
    ...many(150),
  );
  const last = offeredNotices(openNotices(urgent)).slice(-3);
  check(last, ["55 53", "2 a", "1 lost"]);
});

test("of more than a thousand notices those go first that need nobody, then the least urgent", () => {
  const error: Telling = { level: "error", text: "lost" };
  const info: Telling = { level: "info", text: "saved" };
  const kept = keptOf(error, warning("closed"), warning("open"), info, ...many(996, "error"));
  closeNotices(kept, kept.notices.value.slice(1, 2));
  expect([kept.notices.value.length, kept.droppedNotices.value]).toEqual([1_000, 0]);
  const firstAfter = (text: string) => {
    tell(kept, { level: "error", text });
    check(kept.notices.value.slice(-1), [`${kept.notices.value.at(-1)?.id} ${text}`]);
    return [kept.notices.value.length, kept.droppedNotices.value, kept.notices.value[1]?.text];
  };
  expect(firstAfter("a")).toEqual([1_000, 0, "open"]);
  expect(firstAfter("b")).toEqual([1_000, 1, "open"]);
  expect(kept.notices.value[2]?.text).toBe("1");
  expect(firstAfter("c")).toEqual([1_000, 2, "1"]);
  check(kept.notices.value.slice(0, 1), ["1 lost"]);
  expect(firstAfter("d")).toEqual([1_000, 3, "2"]);
});

test("a notice counts with an equal one of the last twenty, and not with one before them", () => {
  const others = (count: number) => Array.from({ length: count }, (_, at) => warning(`${at}`));
  check(noticesAfter(warning("a"), ...others(19), warning("a")).slice(-1), ["21 a (2 times)"]);
  const apart = noticesAfter(warning("a"), ...others(20), warning("a"));
  check([...apart.slice(0, 1), ...apart.slice(-1)], ["1 a", "22 a"]);
});
