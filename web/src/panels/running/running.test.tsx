// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import type { RunNow } from "../../model/generated/protocol.ts";
import { runLine, watched } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { Running } from "./running.tsx";

afterEach(unmount);

/** What the panel says of a run in progress of which nothing active is known. */
async function shownFor(link: RunNow["link"]): Promise<string | null> {
  const { watch } = watched(runLine("live"), { snapshot: null, link });
  const place = shown(<Running />, { watch });
  await settled();
  return place.textContent;
}

test("before a robot was heard nobody knows what is active", async () => {
  expect(await shownFor("silent")).toMatch(/^Not known yet/);
  expect(await shownFor("up")).toMatch(/^Nothing is running/);
});
