import { describe, expect, it } from "vitest";
import type { Notice } from "../../store/page.ts";
import { entryOf, filtered } from "./entries.ts";

const NOTICES: readonly Notice[] = [
  { id: 1, at_ms: 10, level: "info", text: "Connected again" },
  { id: 2, at_ms: 20, level: "warning", text: "Rename was not done" },
  { id: 3, at_ms: 30, level: "error", text: "Not saved: disk full" },
];

describe("the log", () => {
  it("is filtered by level and text", () => {
    const texts = (least: "info" | "warning", query: string) =>
      filtered(NOTICES.map(entryOf), least, query).map(({ text }) => text);
    expect(texts("info", "")).toHaveLength(3);
    expect(texts("warning", " NOT ")).toEqual(["Rename was not done", "Not saved: disk full"]);
    expect(texts("warning", "again")).toEqual([]);
  });
});
