// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { SetAsideDraft } from "../../model/generated/protocol.ts";
import { SLIP_MS } from "../../ui/confirm_press.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { SetAside } from "./set_aside.tsx";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

const DRAFT: SetAsideDraft = {
  id: "17",
  at_ms: 0,
  reason: "R/GONE, state: there is no such state",
  count: 2,
  edits: [{ author: "ann", at_ms: 0, name: "Rename state", what: 'set name R/GONE: name "New"' }],
};

test("edits that were set aside are listed, downloaded and discarded", async () => {
  const requests: string[] = [];
  const serve = (request: string) => {
    requests.push(request);
    return request.startsWith("GET") ? [DRAFT] : undefined;
  };
  const answers: unknown[] = [];
  const { place } = shown((tab) => <SetAside asks={tab} answer={(it) => answers.push(it)} />, {
    serve,
  });
  await settled();
  const items = [...place.querySelectorAll("li")].map((item) => item.textContent);
  expect(items[0]).toContain("Rename state, ann, ");
  expect(items[0]).toContain('set name R/GONE: name "New"');
  expect(items[1]).toBe("and 1 more: see the download");
  expect(place.querySelector("a")?.getAttribute("href")).toBe("/api/v1/machines/m1/set_aside/17");
  const discard = () =>
    [...place.querySelectorAll("button")].find(({ textContent }) => /^Discard/.test(textContent));
  discard()?.click();
  await settled();
  vi.advanceTimersByTime(SLIP_MS + 1);
  discard()?.click();
  await settled();
  expect(requests).toEqual(["GET /machines/m1/set_aside", "DELETE /machines/m1/set_aside/17"]);
  expect(answers).toEqual([null]);
});
