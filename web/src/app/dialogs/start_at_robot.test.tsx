// @vitest-environment happy-dom
import { signal } from "@preact/signals-core";
import { afterEach, expect, test } from "vitest";
import { RefusalError } from "../../store/page/server.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { StartAtRobot } from "./start_at_robot.tsx";

afterEach(() => unmount());

const FILES = ["drive/far", "drive/near", "drill"].map((path) => ({ project: "missions", path }));

function dialog(machines: (robot: string) => unknown) {
  const answers: unknown[] = [];
  const requests: string[] = [];
  const serve = (request: string) => {
    requests.push(request);
    return machines(request.split("/")[2] ?? "");
  };
  const { place, session } = shown(
    () => <StartAtRobot asks={undefined} answer={(it) => answers.push(it)} />,
    { serve, robots: signal(["mule", "scout"]) },
  );
  return { place, session, answers, requests };
}

function texts(place: HTMLElement, selector: string): (string | null)[] {
  return [...place.querySelectorAll(selector)].map(({ textContent }) => textContent);
}

test("the machines of a robot are listed with their age, found by their path and started", async () => {
  const { place, answers, requests } = dialog(() => ({ made_ms: 0, machines: FILES, more: 2 }));
  await settled();
  expect(requests).toEqual(["GET /robots/mule/machines"]);
  expect(texts(place, "[role=treeitem]")).toEqual([
    "missions/drive/far",
    "missions/drive/near",
    "missions/drill",
  ]);
  expect(texts(place, ".form-note")).toEqual([
    "As the robot listed them at 1970-01-01 00:00:00 UTC by its calendar. 2 that changed earlier are not listed.",
  ]);
  const start = () =>
    [...place.querySelectorAll("button")].find((it) => /^Start/.test(it.textContent));
  expect([start()?.textContent, start()?.getAttribute("aria-disabled")]).toEqual([
    "Start on mule",
    "true",
  ]);
  const search = place.querySelector<HTMLInputElement>("input[type=search]");
  if (!search) throw new Error("there is no search");
  search.value = "NEAR";
  search.dispatchEvent(new Event("input", { bubbles: true }));
  await settled();
  expect(texts(place, "[role=treeitem]")).toEqual(["missions/drive/near"]);
  start()?.click();
  expect(answers).toEqual([{ robot: "mule", machine: FILES[1] }]);
});

test("a list that has not arrived is unknown, not empty", async () => {
  const message = "robot mule: no list of its machines has arrived yet";
  const { place } = dialog(() => {
    throw new RefusalError({ code: "machines_unknown", message }, 503);
  });
  await settled();
  expect(place.textContent).toContain("The machines are unknown");
  expect(place.textContent).toContain(message);
});

test("a robot without machines has none", async () => {
  const { place } = dialog(() => ({ made_ms: 0, machines: [], more: 0 }));
  await settled();
  expect(place.textContent).toContain("No project of mule has a machine.");
});
