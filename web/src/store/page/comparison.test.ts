import { signal } from "@preact/signals-core";
import { describe, expect, it, vi } from "vitest";
import type { Document } from "../../model/generated/protocol.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { OptimisticDocument, type TouchedPaths } from "../document/optimistic_document.ts";
import { comparisonOf } from "./comparison.ts";
import type { OpenTab } from "./page.ts";
import { RefusalError, type Server } from "./server.ts";
import { newView } from "./view.ts";

const TEXT = `
  R hierarchy outcome done
    A "Scan" execution outcome ok`;

function setUp(answers: Readonly<Record<string, Document>>) {
  const listeners = new Set<(touched: TouchedPaths) => void>();
  const machine = new OptimisticDocument(sketch(TEXT), () => undefined);
  const onChange = (listener: (touched: TouchedPaths) => void) => {
    listeners.add(listener);
    return () => void listeners.delete(listener);
  };
  const session = {
    id: "m",
    machine,
    onChange,
    status: signal(null),
  } as unknown as OpenTab["session"];
  const tab: OpenTab = { session, view: newView(), run: signal(null) };
  const request = async (_: string, path: string) => {
    const found = answers[path];
    if (found) return found;
    throw new RefusalError({ code: "no_such_commit", message: "there is no such commit" }, 404);
  };
  const comparison = comparisonOf(tab, { request } as unknown as Server);
  const change = (name: string) => {
    const state = machine.state("R/A");
    if (!state) return;
    machine.transact(() => machine.confirm([{ change: "state", state: { ...state, name } }]));
    for (const listener of listeners) listener(null);
  };
  return { tab, comparison, change };
}

describe("a comparison", () => {
  it("finds and marks differences, and finds them again when the machine changes", async () => {
    vi.useFakeTimers();
    const saved = sketch(TEXT.replace('    A "Scan" execution outcome ok', "    B execution"));
    const { tab, comparison, change } = setUp({ "/machines/m/saved": saved });
    await comparison.choose({ kind: "saved" });
    const names = () => comparison.found.value.map(({ kind, name }) => `${kind} ${name}`);
    expect(names()).toEqual(["removed B", "added Scan"]);
    expect(tab.view.marks.value?.get("state:R/A")).toBe("added");
    change("Look");
    vi.runAllTimers();
    expect(names()).toEqual(["removed B", "added Look"]);
    await comparison.choose(null);
    expect([names(), tab.view.marks.value]).toEqual([[], null]);
    vi.useRealTimers();
  });

  it("says why the other side cannot be had", async () => {
    const { comparison } = setUp({});
    await comparison.choose({ kind: "version", commit: "abc" });
    expect(comparison.refusal.value).toBe("there is no such commit");
    expect(comparison.other.value).toBeNull();
  });
});
