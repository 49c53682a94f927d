// @vitest-environment happy-dom
import { beforeEach, expect, test } from "vitest";
import { read, selectionIn, textOf, write } from "./clipboard.ts";

const SELECTION = {
  container: "R",
  states: [{ path: "A", name: "A", kind: "execution" as const }],
};

beforeEach(() => localStorage.clear());

test("states come back from the text that they were written as", () => {
  expect(selectionIn(textOf(SELECTION))).toEqual(SELECTION);
});

test("what is about something else is left alone", () => {
  for (const text of ["", "def execute", "{}", '{"rafcon": 3}', "{broken"]) {
    expect(selectionIn(text)).toBeNull();
  }
});

test("the event's own clipboard is used where there is one", async () => {
  const data = new Map<string, string>();
  const transfer = {
    getData: (kind: string) => data.get(kind) ?? "",
    setData: (kind: string, text: string) => void data.set(kind, text),
  };
  await write(SELECTION, transfer);
  expect(data.get("text/plain")).toBe(textOf(SELECTION));
  expect(await read(transfer)).toEqual(SELECTION);
});

test("without a clipboard of the system, another tab finds the states all the same", async () => {
  Object.defineProperty(navigator, "clipboard", { value: undefined, configurable: true });
  await write(SELECTION, null);
  expect(await read(null)).toEqual(SELECTION);
});
