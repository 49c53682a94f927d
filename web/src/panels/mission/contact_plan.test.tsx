// @vitest-environment happy-dom
import { afterEach, expect, test } from "vitest";
import type { ContactWindow, Right } from "../../model/generated/protocol.ts";
import { RefusalError } from "../../store/page/server.ts";
import { runLine, watched } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { ContactPlan } from "./contact_plan.tsx";

const NOW_MS = Date.UTC(2026, 10, 28, 12);
const PAST: ContactWindow = {
  begin: "2026-11-28T10:00:00Z",
  end: "2026-11-28T10:20:00Z",
  profile: "deep",
};
const KIRUNA: ContactWindow = {
  begin: "2026-11-28T14:00:00Z",
  end: "2026-11-28T14:20:00Z",
  profile: "deep",
  note: "Kiruna",
};

afterEach(unmount);

/** A plan at a server that stores what it is given. */
async function planned(
  plan: readonly ContactWindow[] | null,
  rights: readonly Right[] = ["command"],
) {
  const stored = { plan, refusal: null as string | null };
  const requests: string[] = [];
  const { watch } = watched(runLine("live"), {});
  const serve = (request: string) => {
    requests.push(request);
    if (request.startsWith("GET") && stored.plan !== null) return stored.plan;
    if (stored.refusal !== null || stored.plan === null) {
      const message = stored.refusal ?? "the file of the contacts cannot be read";
      throw new RefusalError({ code: "bad_request", message }, 400);
    }
    stored.plan = JSON.parse(request.slice(request.indexOf("[")));
    return undefined;
  };
  const place = shown(<ContactPlan robot="scout" now_ms={NOW_MS} onClose={() => {}} />, {
    watch,
    options: { rights, serve },
  });
  await settled();
  const press = async (name: string) => {
    const buttons = [...place.querySelectorAll("button")];
    buttons
      .find((button) => (button.getAttribute("aria-label") ?? button.textContent) === name)
      ?.click();
    await settled();
  };
  const fill = async (label: string, value: string) => {
    const labels = [...place.querySelectorAll("label")];
    const id = labels.find(({ textContent }) => textContent === label)?.htmlFor ?? "";
    const field = place.querySelector<HTMLInputElement>(`#${CSS.escape(id)}`);
    const prototype = Object.getPrototypeOf(field);
    Object.getOwnPropertyDescriptor(prototype, "value")?.set?.call(field, value);
    field?.dispatchEvent(
      new Event(field.tagName === "SELECT" ? "change" : "input", { bubbles: true }),
    );
    await settled();
  };
  const lines = () => [...place.querySelectorAll("li > span")].map((line) => line.textContent);
  return { place, stored, requests, press, fill, lines };
}

test("contacts that are not over are shown", async () => {
  const { lines } = await planned([PAST, KIRUNA]);
  expect(lines()).toEqual(["14:00:00 UTC to 14:20:00 UTC, profile deep, Kiruna"]);
});

test("a contact is added in its order", async () => {
  const { place, stored, press, fill, lines } = await planned([KIRUNA]);
  await fill("Begin (UTC)", "2026-11-28 13:00");
  await fill("End (UTC)", "2026-11-28 13:10");
  await fill("Link profile", "wifi");
  await press("Add contact");
  const added = { begin: "2026-11-28T13:00:00Z", end: "2026-11-28T13:10:00Z", profile: "wifi" };
  expect(stored.plan).toEqual([added, KIRUNA]);
  await settled();
  expect([...place.querySelectorAll("input")].map(({ value }) => value)).toEqual(["", "", ""]);
  expect(lines()[0]).toBe("13:00:00 UTC to 13:10:00 UTC, profile wifi");
});

test("a time that is none, and a refusal of the server, keep what was entered", async () => {
  const { place, stored, requests, press, fill } = await planned([KIRUNA]);
  await fill("Begin (UTC)", "2 p.m.");
  await press("Add contact");
  expect(place.querySelector("[role=alert]")?.textContent).toBe(
    "Begin: enter a time in UTC, such as 2026-11-28 14:10:00",
  );
  expect(requests).toEqual(["GET /robots/scout/contacts"]);
  stored.refusal = "the windows 1 and 2 overlap";
  await fill("Begin (UTC)", "2026-11-28 14:10");
  await fill("End (UTC)", "2026-11-28 14:30");
  await press("Add contact");
  expect(place.querySelector("input")?.value).toBe("2026-11-28 14:10");
  expect(stored.plan).toEqual([KIRUNA]);
});

test("a plan that somebody else has changed is shown again and not replaced", async () => {
  const { stored, press, lines } = await planned([KIRUNA]);
  stored.plan = [{ ...KIRUNA, note: "Svalbard" }];
  await press("Remove the contact at 2026-11-28T14:00:00Z");
  expect(stored.plan).toEqual([{ ...KIRUNA, note: "Svalbard" }]);
  expect(lines()).toEqual(["14:00:00 UTC to 14:20:00 UTC, profile deep, Svalbard"]);
});

test("the last contact can be removed, and viewers cannot", async () => {
  const { stored, press } = await planned([KIRUNA]);
  await press("Remove the contact at 2026-11-28T14:00:00Z");
  expect(stored.plan).toEqual([]);
  unmount();
  const { place } = await planned([KIRUNA], ["observe"]);
  const buttons = [...place.querySelectorAll("button")].filter(
    (button) => button.getAttribute("aria-disabled") === "true",
  );
  expect(buttons).toHaveLength(2);
});

test("a plan that cannot be read can be closed", async () => {
  const { place } = await planned(null);
  expect(place.textContent).toBe("Close planned contacts");
});
