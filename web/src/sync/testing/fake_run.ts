/** A server with one run, of a few lines, for tests: it tells the history from the cursor that is asked for, in frames as large as a
 * test wants and cut off where it wants, and answers requests as the test says. */

import { signal } from "@preact/signals-core";
import type {
  ActiveSince,
  Event,
  HistoryEntry,
  Refusal,
  RunNow,
  ToClient,
} from "../../model/generated/protocol.ts";
import {
  type Follower,
  type Link,
  RefusalError,
  type Server,
  type ServerPulse,
} from "../../store/page/server.ts";

/** A request that waits for its answer. */
export interface Asked {
  readonly method: string;
  readonly path: string;
  readonly body: unknown;
  readonly answer: (value: unknown) => void;
  readonly refuse: (status: number, message?: string) => void;
}

interface Subscription {
  readonly follower: Follower;
  topic: string;
  next: number;
  isCaughtUp: boolean;
}

export class FakeRun implements Server {
  readonly link = signal<Link>({ state: "connecting" });
  readonly pulse = signal<ServerPulse | null>(null);
  readonly events: HistoryEntry[] = [];
  /** All that was ever asked, and those without an answer. */
  readonly asked: string[] = [];
  waiting: Asked[] = [];
  #subscriptions: Subscription[] = [];

  request: Server["request"] = <T>(method: string, path: string, body?: unknown) =>
    new Promise<T>((answered, failed) => {
      this.asked.push(`${method} ${path}`);
      const over = (act: () => void) => {
        this.waiting = this.waiting.filter((each) => each !== asked);
        act();
      };
      const asked: Asked = {
        method,
        path,
        body,
        answer: (value) => over(() => answered(value as T)),
        refuse: (status, message = "no") =>
          over(() => failed(new RefusalError({ code: "no", message }, status))),
      };
      this.waiting.push(asked);
    });

  lines: Server["lines"] = async () => {
    throw new RefusalError({ code: "no_planner", message: "nothing plans here" }, 404);
  };

  follow: Server["follow"] = (follower) => {
    const subscription = { follower, topic: "", next: 0, isCaughtUp: false };
    this.#subscriptions.push(subscription);
    this.#subscribe(subscription);
    return () => {
      this.#subscriptions = this.#subscriptions.filter((each) => each !== subscription);
    };
  };

  onAnswer = () => () => {};
  say(): void {}
  retry(): void {}

  /** Something happens in the run. */
  happen(event: Event): void {
    const sequence = this.events.length + 1;
    this.events.push({ sequence, t_ns: sequence * 1e6, event });
  }

  /** Tells at most so many events, or once that there are no more. */
  tell(count: number): void {
    for (const subscription of this.#of("run_history")) {
      const { next } = subscription;
      const events = this.events.slice(next - 1, next - 1 + count);
      subscription.next += events.length;
      if (events.length === 0 && subscription.isCaughtUp) continue;
      if (events.length === 0) subscription.isCaughtUp = true;
      this.#frame(subscription, {
        frame: "events",
        subscription: 1,
        events,
        next: subscription.next,
      });
    }
  }

  /** The connection breaks and comes back: whoever follows is asked where to go on. */
  breakUp(): void {
    for (const subscription of this.#subscriptions) this.#subscribe(subscription);
  }

  /** Sends a frame again. */
  repeat(from: number, count: number): void {
    for (const subscription of this.#of("run_history")) {
      const events = this.events.slice(from - 1, Math.min(from - 1 + count, subscription.next - 1));
      const next = from + events.length;
      if (events.length > 0) {
        this.#frame(subscription, { frame: "events", subscription: 1, events, next });
      }
    }
  }

  /** All events up to one are left out. */
  skipped(sequence: number, active: ActiveSince[]): void {
    for (const subscription of this.#of("run_history")) {
      subscription.next = sequence + 1;
      const before = { sequence, t_ns: sequence * 1e6, active };
      this.#frame(subscription, { frame: "skipped", subscription: 1, before });
    }
  }

  setStatus(now: RunNow): void {
    for (const subscription of this.#of("run_status")) {
      this.#frame(subscription, { frame: "run_status", subscription: 2, status: now });
    }
  }

  end(topic: "run_history" | "run_status", refusal: Refusal | null = null): void {
    for (const subscription of this.#of(topic)) {
      this.#subscriptions = this.#subscriptions.filter((each) => each !== subscription);
      this.#frame(subscription, { frame: "ended", subscription: 1, refusal });
    }
  }

  /** How many follow. */
  count(topic: "run_history" | "run_status"): number {
    return this.#of(topic).length;
  }

  /** The oldest request that waits. */
  first(): Asked {
    const [first] = this.waiting;
    if (!first) throw new Error("nothing was asked");
    return first;
  }

  #subscribe(subscription: Subscription): void {
    const topic = subscription.follower.topic();
    subscription.topic = topic.topic === "run_newest" ? "run_history" : topic.topic;
    subscription.isCaughtUp = false;
    if (topic.topic === "run_newest") this.#begin(subscription, topic);
  }

  /** Of too many events only the newest are sent. */
  #begin(
    subscription: Subscription,
    { from, most, newest }: { from: number; most: number; newest: number },
  ): void {
    subscription.next = from;
    if (this.events.length + 1 - from <= most) return;
    subscription.next = this.events.length + 1 - newest;
    const before = {
      sequence: subscription.next - 1,
      t_ns: (subscription.next - 1) * 1e6,
      active: [],
    };
    this.#frame(subscription, { frame: "skipped", subscription: 1, before });
  }

  #of(wanted: string): readonly Subscription[] {
    return this.#subscriptions.filter(({ topic }) => topic === wanted);
  }

  #frame({ follower }: Subscription, frame: ToClient): void {
    follower.frame(frame);
  }
}
