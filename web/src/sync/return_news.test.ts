import { expect, it } from "vitest";
import type { Telling } from "../store/page/notices.ts";
import { gatherReturnNews } from "./return_news.ts";
import { FakeClock } from "./testing/fake_clock.ts";

it("makes one notice of what eight tabs report after a restart", () => {
  const clock = new FakeClock();
  const notices: Telling[] = [];
  const news = gatherReturnNews(clock, (notice) => notices.push(notice));
  for (let number = 1; number <= 8; number += 1) news.reloaded(`M${number}`);
  news.restored("M1");
  expect(notices).toEqual([]);
  clock.pass(1_000);
  expect(notices.map(({ text }) => text)).toEqual([
    "Reloaded from the server: “M1”, “M2” and 6 more. Unsaved edits from before the server ended are restored: “M1”.",
  ]);
  clock.pass(10_000);
  news.restored("M2");
  clock.pass(1_000);
  expect(notices.at(1)?.text).toBe(
    "Unsaved edits from before the server ended are restored: “M2”.",
  );
});
