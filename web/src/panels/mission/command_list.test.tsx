// @vitest-environment happy-dom
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type {
  CommandList,
  LinkHealth,
  LinkRights,
  ListLine,
  Right,
} from "../../model/generated/protocol.ts";
import { RefusalError } from "../../store/page/server.ts";
import { runLine, watched } from "../../store/testing/watched.ts";
import { settled, unmount } from "../../ui/testing/mounted.tsx";
import { shown } from "../testing/shown.tsx";
import { CommandListPart } from "./command_list.tsx";

const NOW_MS = Date.UTC(2026, 10, 28, 12);

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  unmount();
  vi.useRealTimers();
});

const ROBOT = {
  robot: "scout",
  is_heard: true,
  commands: [],
  contact: { begin_ms: NOW_MS + 300_000, end_ms: NOW_MS + 900_000, profile: "deep" },
} as unknown as LinkHealth;

const PAUSE: ListLine = {
  listed: { run: "drill-1", command: { type: "pause" } },
  send_at_ms: NOW_MS + 60_000,
  effect_ms: NOW_MS + 62_000,
  expires_ms: NOW_MS + 120_000,
};
const STOP: ListLine = { listed: { run: "other", command: { type: "stop" } } };

interface Options {
  readonly rights?: readonly Right[];
  readonly pairing?: LinkRights;
  readonly isSure?: boolean;
  readonly serve?: (request: string) => CommandList;
}

/** A list, as the server has it, with what was requested of the server. */
async function listed(list: CommandList, options: Options = {}) {
  const { rights = ["observe", "command"], pairing = "command", isSure = true } = options;
  const requests: string[] = [];
  const robot = { ...ROBOT, rights: pairing };
  const { watch } = watched(runLine("live"), { robot });
  const serve = (request: string) => {
    requests.push(request);
    return request.startsWith("GET") ? list : options.serve?.(request);
  };
  const place = shown(<CommandListPart watch={watch} robot={robot} now_ms={NOW_MS} />, {
    watch,
    options: { rights, answers: [isSure], serve },
  });
  await settled();
  const press = async (name: string) => {
    const buttons = [...place.querySelectorAll("button")];
    buttons.find((button) => nameOf(button) === name)?.click();
    await settled();
  };
  return { place, requests, press };
}

/** Enters a value into the field with this label. */
async function fill(place: HTMLElement, label: string, value: string) {
  const found = [...place.querySelectorAll("label")].find(
    ({ textContent }) => textContent === label,
  );
  const field = place.querySelector<HTMLInputElement>(`#${CSS.escape(found?.htmlFor ?? "")}`);
  if (field === null) throw new Error(`there is no field ${label}`);
  const prototype = Object.getPrototypeOf(field);
  Object.getOwnPropertyDescriptor(prototype, "value")?.set?.call(field, value);
  const event = field.tagName === "SELECT" ? "change" : "input";
  field.dispatchEvent(new Event(event, { bubbles: true }));
  await settled();
}

function nameOf(button: HTMLElement): string {
  return button.getAttribute("aria-label") ?? button.textContent ?? "";
}

function linesOf(place: HTMLElement): readonly string[] {
  return [...place.querySelectorAll(".command-list > p, li > span")].map(
    (line) => line.textContent ?? "",
  );
}

test("an empty list is a button only", async () => {
  const { place } = await listed({ revision: "7", lines: [] });
  expect(place.textContent).toBe("Add a timed command…");
});

test("a command is added to the list with its times", async () => {
  const serve = (): CommandList => ({ revision: "8", lines: [STOP, PAUSE] });
  const { place, requests, press } = await listed({ revision: "7", lines: [STOP] }, { serve });
  await press("Add a command…");
  await fill(place, "Command", "resume");
  await fill(place, "Takes effect", "contact");
  await press("Add to the list");
  expect(place.querySelector("[role=alert]")?.textContent).toBe(
    "Takes effect: enter seconds after the begin of the contact, such as 30",
  );
  expect(requests).toEqual(["GET /robots/scout/commands"]);
  await fill(place, "Takes effect, seconds after the begin", "30");
  await fill(place, "Expires", "utc");
  await fill(place, "Expires at (UTC)", "2026-11-28 12:10:00");
  await press("Add to the list");
  const resume = {
    run: "drill-1",
    command: { type: "resume", branch: null },
    not_before: { contact: "2026-11-28T12:05:00Z", after_s: 30 },
    expiry: "2026-11-28T12:10:00Z",
  };
  expect(requests.at(-1)).toBe(
    `PUT /robots/scout/commands?revision=7 ${JSON.stringify([STOP.listed, resume])}`,
  );
  expect(place.querySelector(".command-list-entry")).toBeNull();
});

test("after a refusal the form keeps what was entered", async () => {
  const serve = (): CommandList => {
    throw new RefusalError({ code: "command_list_changed", message: "it was changed" }, 409);
  };
  const { place, press } = await listed({ revision: "7", lines: [] }, { serve });
  await press("Add a timed command…");
  await fill(place, "Command", "json");
  await fill(place, "Command as JSON", '{"type": "step_mode"}');
  await press("Add to the list");
  expect(place.querySelector("textarea")?.value).toBe('{"type": "step_mode"}');
});

test("a command after a release begins a new list", async () => {
  const released = { at_ms: NOW_MS, user: "ana" };
  const { requests, press } = await listed({ revision: "7", released, lines: [STOP] });
  await press("Begin a new list…");
  await press("Add to the list");
  expect(requests.at(-1)).toBe(
    `PUT /robots/scout/commands?revision=7 ${JSON.stringify([PAUSE.listed])}`,
  );
});

test("each command has its times, and its fault if it has one", async () => {
  const fault = "its time is past: choose a later one";
  const { place } = await listed({ revision: "7", lines: [PAUSE, { ...STOP, fault }] });
  expect(linesOf(place)).toEqual([
    "Command list: not released",
    "Pause: sent in 1:00, at 12:01:00 UTC, takes effect in 1:02, at 12:01:02 UTC, expires in 2:00, at 12:02:00 UTC",
    "Stop, run other: sent at the release, time of effect unknown",
    "its time is past: choose a later one",
  ]);
  const release = [...place.querySelectorAll("button")].at(-2);
  expect(release?.title).toBe("nothing is sent while a command has a fault");
});

test("a line is removed, and the rest is set again", async () => {
  const serve = (): CommandList => ({ revision: "8", lines: [STOP] });
  const { place, requests, press } = await listed(
    { revision: "7", lines: [PAUSE, STOP] },
    { serve },
  );
  await press("Remove line 1");
  expect(requests.at(-1)).toBe(
    `PUT /robots/scout/commands?revision=7 ${JSON.stringify([{ run: "other", command: { type: "stop" } }])}`,
  );
  expect(linesOf(place)).toEqual([
    "Command list: not released",
    "Stop, run other: sent at the release, time of effect unknown",
  ]);
});

test("the reviewed revision is released after a question, and the fates are shown", async () => {
  const list: CommandList = { revision: "7", lines: [PAUSE, STOP] };
  const cancelled = await listed(list, { isSure: false });
  await cancelled.press("Release…");
  expect(cancelled.requests).toEqual(["GET /robots/scout/commands"]);
  unmount();
  const serve = (): CommandList => ({
    revision: "7",
    released: { at_ms: NOW_MS, user: "ana" },
    lines: [
      { ...PAUSE, fate: { fate: "open", stage: "received" } },
      { ...STOP, fate: { fate: "answered", answer: { answer: "unknown", reason: "it is over" } } },
    ],
  });
  const { place, requests, press } = await listed(list, { serve });
  await press("Release…");
  expect(requests.at(-1)).toBe('POST /robots/scout/commands/release {"revision":"7"}');
  expect(linesOf(place)).toEqual([
    "Command list: released by ana at 12:00:00 UTC",
    "Pause: the robot has it, takes effect in 1:02, at 12:01:02 UTC",
    "Stop, run other: unknown whether it was carried out: it is over",
  ]);
  expect([...place.querySelectorAll("button")].map(nameOf)).toEqual([
    "Release again…",
    "Begin a new list…",
  ]);
});

test("a refused release is reported, and the list is requested again", async () => {
  const serve = (): CommandList => {
    throw new RefusalError({ code: "command_list_changed", message: "it was changed" }, 409);
  };
  const { place, requests, press } = await listed({ revision: "7", lines: [STOP] }, { serve });
  await press("Release…");
  expect(requests.at(-1)).toBe("GET /robots/scout/commands");
  expect(linesOf(place)[0]).toBe("Command list: not released");
});

test("without the right of the user or of the pairing, the buttons say why", async () => {
  const list: CommandList = { revision: "7", lines: [STOP] };
  const reasons = async (options: Options) => {
    const { place } = await listed(list, options);
    const buttons = [...place.querySelectorAll("button")];
    const words = buttons.map((button) => [button.getAttribute("aria-disabled"), button.title]);
    unmount();
    return words;
  };
  const viewer =
    "only operators, engineers and admins may command runs: ask an admin for the role operator";
  expect(await reasons({ rights: ["observe"] })).toEqual([
    ["true", viewer],
    ["true", viewer],
    ["true", viewer],
  ]);
  const [, release] = await reasons({ pairing: "observe" });
  expect(release?.[1]).toContain("scout lets users of this station only see runs");
});
