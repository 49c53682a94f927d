import { expect, test } from "vitest";
import { EMPTY_ENTRY, type ListEntry, listedCommand } from "./list_entry.ts";

const CONTACT_MS = Date.UTC(2026, 10, 28, 14);

/** The entry as a command, or its fault. */
function made(part: Partial<ListEntry>, contact_ms: number | undefined = CONTACT_MS): string {
  const command = listedCommand({ ...EMPTY_ENTRY, ...part }, "r", contact_ms);
  return "fault" in command ? command.fault : JSON.stringify(command);
}

test("times are in UTC or count from the begin of the contact", () => {
  const utc = (effectText: string) => made({ effect: "utc", effectText });
  const at = (time: string) => `{"run":"r","command":{"type":"pause"},"not_before":"${time}"}`;
  expect(utc("2026-11-28 14:10:00")).toBe(at("2026-11-28T14:10:00Z"));
  expect(utc(" 2026-11-28T14:10:00Z ")).toBe(at("2026-11-28T14:10:00Z"));
  expect(utc("2026-11-28 14:10")).toBe(at("2026-11-28T14:10:00Z"));
  expect(utc("2026-11-28 14:10:00.25")).toBe(at("2026-11-28T14:10:00.250Z"));
  expect(made({ expiry: "contact", expiryText: "0" })).toBe(
    '{"run":"r","command":{"type":"pause"},"expiry":{"contact":"2026-11-28T14:00:00Z","after_s":0}}',
  );
});

test("a time that is none says what to enter", () => {
  const wrong = "Takes effect: enter a time in UTC, such as 2026-11-28 14:10:00";
  for (const effectText of ["", "14:10", "2026-13-28 14:10:00", "tomorrow", "2026-11-28 25:00"]) {
    expect(made({ effect: "utc", effectText })).toBe(wrong);
  }
  for (const expiryText of ["", " ", "-1", "soon", "Infinity"]) {
    expect(made({ expiry: "contact", expiryText })).toBe(
      "Expires: enter seconds after the begin of the contact, such as 30",
    );
  }
  const without = listedCommand({ ...EMPTY_ENTRY, effect: "contact" }, "r", undefined);
  expect(without).toEqual({ fault: "Takes effect: no contact is planned" });
});

test("another command is an object with a type", () => {
  const json = (text: string) => made({ kind: "json", json: text });
  expect(json('{"type": "run_to", "path": "A/B"}')).toBe(
    '{"run":"r","command":{"type":"run_to","path":"A/B"}}',
  );
  for (const text of ["", "pause", '"pause"', "[]", "{}", "null", '{"type"']) {
    expect(json(text)).toMatch(/^Command: write an object with a type/);
  }
});
