// @vitest-environment happy-dom
import { beforeEach, expect, test } from "vitest";
import { clipIn, read, textOf, write } from "./clipboard.ts";

const CLIP = {
  selection: { container: "R", states: [{ path: "A", name: "A", kind: "execution" as const }] },
  ways: { transitions: [[{ x: 1, y: 2 }]], data_flows: [] },
  parts: [
    { kind: "outcome" as const, name: "done" },
    { kind: "input" as const, name: "speed", data_type: "float", default: 0.5 },
  ],
};

beforeEach(() => localStorage.clear());

test("states come back from the text that they were written as", () => {
  expect(clipIn(textOf(CLIP))).toEqual(CLIP);
});

test("what is about something else is left alone", () => {
  const texts = ["", "def execute", "{}", '{"rafcon": 3}', '{"parts": [{"kind": "input"}, null]}'];
  for (const text of [...texts, "{broken"]) {
    expect(clipIn(text)).toBeNull();
  }
});

test("the event's own clipboard is used where there is one", async () => {
  const data = new Map<string, string>();
  const transfer = {
    getData: (kind: string) => data.get(kind) ?? "",
    setData: (kind: string, text: string) => void data.set(kind, text),
  };
  await write(CLIP, transfer);
  expect(data.get("text/plain")).toBe(textOf(CLIP));
  expect(await read(transfer)).toEqual(CLIP);
});

test("without a clipboard of the system, another tab finds the states all the same", async () => {
  Object.defineProperty(navigator, "clipboard", { value: undefined, configurable: true });
  await write(CLIP, null);
  expect(await read(null)).toEqual(CLIP);
});
