import { signal } from "@preact/signals-core";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { readExpression } from "../../model/expression.ts";
import type { Event, EventPage } from "../../model/generated/protocol.ts";
import type { Runs, Watch } from "../history/run.ts";
import { RefusalError } from "../page/server.ts";
import { ValueHistory, valueIn } from "./value_history.ts";
import type { Target } from "./watched_values.ts";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

const COUNT: Target = { kind: "scoped_variable", path: "R/A", name: "count" };

function scoped(path: string, name: string, value: number): Event {
  return { type: "scoped", path, name, value };
}

/** A server with these events, three per page. */
class EventServer {
  readonly asked: string[] = [];
  readonly events: Event[] = [];
  isDown = false;
  readonly next = signal(1);
  readonly runs = { get: (_run: string, what: string) => this.#get(what) } as unknown as Runs;
  readonly watch = {
    id: "run",
    journalVersion: signal(0),
    journal: { next: 1 },
  } as unknown as Watch & { journalVersion: { value: number }; journal: { next: number } };

  happen(...events: Event[]): void {
    this.events.push(...events);
    this.watch.journal.next = this.events.length + 1;
    this.watch.journalVersion.value = this.events.length;
  }

  async #get(what: string): Promise<EventPage> {
    this.asked.push(what);
    if (this.isDown) throw new RefusalError({ code: "away", message: "the server is away" }, 0);
    const from = Number(new URLSearchParams(what.split("?")[1]).get("from"));
    const events = this.events
      .map((event, index) => ({ sequence: index + 1, t_ns: index * 1e9, event }))
      .slice(from - 1, from + 2);
    return { events, next: from + events.length, last: this.events.length };
  }
}

function historyOf(server: EventServer, target = COUNT, text = "value * 2"): ValueHistory {
  const expression = readExpression(text);
  if ("refused" in expression) throw new Error(expression.refused);
  return new ValueHistory(server.runs, server.watch, target, expression);
}

test("only the state itself is asked for, none of its siblings", async () => {
  const asked = async (path: string) => {
    const server = new EventServer();
    const stop = historyOf(server, { ...COUNT, path }).follow();
    await vi.advanceTimersByTimeAsync(0);
    stop();
    return new URLSearchParams(server.asked[0]?.split("?").slice(1).join("?")).get("state");
  };
  expect(await asked("R/A")).toBe("R?A");
  expect(await asked("R/S/ABC*")).toBe("R/S?ABC*");
  expect(await asked("ROOT")).toBe("?OOT");
});

test("what there was page by page, then what comes; other values are left out", async () => {
  const server = new EventServer();
  server.happen(scoped("R/A", "count", 1), scoped("R/A", "other", 9), scoped("R/B", "count", 9));
  server.happen(scoped("R/A", "count", 2));
  const history = historyOf(server);
  const stop = history.follow();
  await vi.advanceTimersByTimeAsync(100);
  expect(history.series.points.map(({ value }) => value)).toEqual([2, 4]);
  expect(history.isLoaded.value).toBe(true);
  expect(server.asked[0]).toContain("kinds=scoped&state=R%3FA");
  server.happen(scoped("R/A", "count", 5));
  await vi.advanceTimersByTimeAsync(2_000);
  expect(history.series.points.map(({ value }) => value)).toEqual([2, 4, 10]);
  const count = server.asked.length;
  stop();
  server.happen(scoped("R/A", "count", 6));
  await vi.advanceTimersByTimeAsync(10_000);
  expect(server.asked).toHaveLength(count);
});

test("a refusal is told, and tried again", async () => {
  const server = new EventServer();
  server.happen(scoped("R/A", "count", 1));
  server.isDown = true;
  const history = historyOf(server);
  history.follow();
  await vi.advanceTimersByTimeAsync(100);
  expect(history.refusal.value).toBe("the server is away");
  server.isDown = false;
  await vi.advanceTimersByTimeAsync(5_000);
  expect(history.refusal.value).toBeNull();
  expect(history.series.count).toBe(1);
});

test("what an event says of a value", () => {
  const input: Target = { kind: "input", path: "A", name: "x" };
  const entered: Event = { type: "entered", path: "A", inputs: { x: 1 } };
  expect(valueIn(entered, input)).toBe(1);
  expect(valueIn({ ...entered, undoes: 3 }, input)).toBeUndefined();
  expect(valueIn({ ...entered, path: "A/B" }, input)).toBeUndefined();
  expect(valueIn({ ...entered, inputs: {} }, input)).toBeUndefined();
  const left: Event = {
    type: "left",
    path: "A",
    outcome: { id: 0, name: "ok" },
    outputs: { x: 2 },
  };
  expect(valueIn(left, { ...input, kind: "output" })).toBe(2);
  expect(valueIn(left, input)).toBeUndefined();
  const global: Target = { kind: "global", path: "", name: "x" };
  expect(valueIn({ type: "global", name: "x", value: null }, global)).toBeNull();
});
