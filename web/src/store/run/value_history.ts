/** One value of a run over time, requested from the server with its events: the existing ones first, then new ones. */

import { effect, type ReadonlySignal, signal } from "@preact/signals-core";
import type { Expression } from "../../model/expression.ts";
import type { Event, EventPage, HistoryEntry, JsonValue } from "../../model/generated/protocol.ts";
import type { Runs, Watch } from "../history/run.ts";
import { Series } from "../history/series.ts";
import { LatestRequest } from "../page/latest_request.ts";
import type { Target } from "./watched_values.ts";

/** Number of events per request, and least interval of requests. */
const PAGE = 1_000;
const PACE_MS = 500;
/** Retry interval after a refusal. */
const AGAIN_MS = 3_000;

export class ValueHistory {
  readonly series = new Series();
  readonly #changed = signal(0);
  readonly #refusal = signal<string | null>(null);
  readonly #isLoaded = signal(false);
  readonly #watch: Watch;
  readonly #target: Target;
  readonly #expression: Expression;
  #next = 1;
  readonly #request: LatestRequest<number, EventPage>;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(runs: Runs, watch: Watch, target: Target, expression: Expression) {
    this.#watch = watch;
    this.#target = target;
    this.#expression = expression;
    this.#request = new LatestRequest({
      ask: () => runs.get(watch.id, this.#question()),
      take: (page) => this.#receive(page),
      refused: ({ message }) => {
        this.#refusal.value = message;
      },
      isRepeated: () => true,
      again_ms: AGAIN_MS,
    });
  }

  /** Changes whenever the series has grown. */
  get changed(): ReadonlySignal<number> {
    return this.#changed;
  }

  /** Reason why the value is unavailable at present. */
  get refusal(): ReadonlySignal<string | null> {
    return this.#refusal;
  }

  /** True once all existing events were received. */
  get isLoaded(): ReadonlySignal<boolean> {
    return this.#isLoaded;
  }

  /** Follows the run until the returned function is called. */
  follow(): () => void {
    this.#soon(0);
    const stop = effect(() => {
      this.#watch.journalVersion.value;
      this.#soon(PACE_MS);
    });
    return () => {
      stop();
      clearTimeout(this.#timer);
      this.#request.close();
    };
  }

  #soon(wait_ms: number): void {
    if (this.#request.isPending) return;
    this.#timer ??= setTimeout(() => {
      this.#timer = undefined;
      this.#request.want(this.#next);
    }, wait_ms);
  }

  #receive(page: EventPage): void {
    for (const entry of page.events) this.#take(entry);
    this.#next = page.next;
    this.#refusal.value = null;
    if (page.events.length > 0) this.#changed.value += 1;
    const isWhole = page.next > page.last;
    if (isWhole) this.#isLoaded.value = true;
    if (!isWhole) this.#request.want(page.next);
    else if (this.#watch.journal.next > page.next) this.#soon(PACE_MS);
  }

  #question(): string {
    const { kind, path } = this.#target;
    const query = new URLSearchParams({
      values: "true",
      from: String(this.#next),
      count: String(PAGE),
      kinds: KINDS[kind],
    });
    if (kind !== "global") query.set("state", onlyThis(path));
    return `events?${query}`;
  }

  #take({ sequence, t_ns, event }: HistoryEntry): void {
    const value = valueIn(event, this.#target);
    if (value === undefined) return;
    const worked = this.#expression.of(value);
    if ("value" in worked) this.series.add(sequence, t_ns, worked.value);
  }
}

/** Pattern that matches only this state's path. A pattern has to match the whole path, so inner states are excluded. The wildcard
 * replaces the `/` before the id, so that siblings with ids of equal length do not match. */
function onlyThis(path: string): string {
  const at = Math.max(0, path.lastIndexOf("/"));
  return `${path.slice(0, at)}?${path.slice(at + 1)}`;
}

const KINDS: Readonly<Record<Target["kind"], string>> = {
  input: "entered",
  output: "left",
  scoped_variable: "scoped",
  global: "global",
};

/** Value of the target in an event; undefined if it has none. Steps back have none. */
export function valueIn(event: Event, { kind, path, name }: Target): JsonValue | undefined {
  const isHere = "path" in event && event.path === path;
  switch (event.type) {
    case "entered":
    case "left": {
      if (!isHere || event.undoes != null) return undefined;
      if (kind === "input" && event.type === "entered") return given(event.inputs, name);
      return kind === "output" && event.type === "left" ? given(event.outputs, name) : undefined;
    }
    case "scoped":
      return isHere && kind === "scoped_variable" && event.name === name ? event.value : undefined;
    case "global":
      return kind === "global" && event.name === name ? event.value : undefined;
    default:
      return undefined;
  }
}

function given(
  values: Record<string, unknown> | null | undefined,
  name: string,
): JsonValue | undefined {
  return values && Object.hasOwn(values, name) ? (values[name] as JsonValue) : undefined;
}
