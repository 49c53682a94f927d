/** Overviews of parts of a run that are not loaded, computed by the server. One is requested at a time, and the previous one is
 * shown meanwhile. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import type { Overview } from "../../model/generated/protocol.ts";
import { lanesSeen, type SeenLane } from "../../store/history/seen.ts";
import { LatestRequest } from "../../store/page/latest_request.ts";
import type { TimeSpan } from "./span.ts";

export interface Seen {
  readonly span: TimeSpan;
  readonly width: number;
  readonly lanes: readonly SeenLane[];
  /** Last event that it includes. */
  readonly sequence: number;
  readonly concurrent: readonly string[];
}

type AskOverview = (what: string) => Promise<Overview>;

interface WantedPart {
  readonly span: TimeSpan;
  readonly width: number;
  /** Last event of the run. */
  readonly last: number;
}

/** Refresh interval of the newest part of an active run, in ms. */
const FRESH_MS = 1_000;
const PIXELS_MAX = 10_000;

export class Overviews {
  readonly #ask: AskOverview;
  readonly #seen = signal<Seen | null>(null);
  /** Widest loaded part. It is shown at low resolution while a more detailed part loads. */
  #widest: Seen | null = null;
  #wanted: WantedPart | null = null;
  #asked_ms = 0;
  readonly #request = new LatestRequest<WantedPart, Seen>({
    ask: (part) => this.#fetch(part),
    take: (seen) => this.#take(seen),
    takeEarlier: (seen) => {
      // It may show the newest part, too.
      this.#take(seen);
      this.#load();
    },
  });

  constructor(ask: AskOverview) {
    this.#ask = ask;
  }

  /** Overview that was loaded last. */
  get seen(): ReadonlySignal<Seen | null> {
    return this.#seen;
  }

  /** Best overview of a part: the last one if it covers the part, or else the widest. Reads a signal. */
  best({ from_ns, to_ns }: TimeSpan): Seen | null {
    const seen = this.#seen.value;
    const has = (each: Seen | null) =>
      each !== null && each.span.from_ns <= from_ns && each.span.to_ns >= to_ns;
    return has(seen) || !has(this.#widest) ? seen : this.#widest;
  }

  /** Requests a part with a width in CSS pixels, of a run with this last event. */
  want(span: TimeSpan, width: number, last: number): void {
    this.#wanted = { span, width, last };
    this.#load();
  }

  #load(): void {
    if (!this.#wanted || this.#isHere(this.#wanted)) this.#request.drop();
    else this.#request.want(this.#wanted);
  }

  #fetch({ span, width }: WantedPart): Promise<Seen> {
    const wider = around(span);
    const pixels = Math.min(PIXELS_MAX, Math.ceil((width * length(wider)) / length(span)));
    const [from, to] = [Math.floor(wider.from_ns), Math.ceil(wider.to_ns)];
    this.#asked_ms = performance.now();
    return this.#ask(`overview?from_ns=${from}&to_ns=${to}&pixels=${pixels}`).then((found) => {
      const { sequence, concurrent } = found;
      return { span: wider, width: pixels, lanes: lanesSeen(found), sequence, concurrent };
    });
  }

  #take(seen: Seen): void {
    const isWidest = this.#widest === null || length(seen.span) >= length(this.#widest.span);
    if (isWidest) this.#widest = seen;
    this.#seen.value = seen;
  }

  #isHere({ span, width, last }: WantedPart): boolean {
    const seen = this.#seen.peek();
    if (!seen) return false;
    const isIn = seen.span.from_ns <= span.from_ns && seen.span.to_ns >= span.to_ns;
    const [scale, wanted] = [seen.width / length(seen.span), width / length(span)];
    if (!isIn || scale < wanted * 0.9 || scale > wanted * 3) return false;
    return seen.sequence >= last || performance.now() - this.#asked_ms < FRESH_MS;
  }
}

/** Span extended by half its length on each side, so that it can be panned. */
function around(span: TimeSpan): TimeSpan {
  const room = length(span) / 2;
  return { from_ns: Math.max(0, span.from_ns - room), to_ns: span.to_ns + room };
}

function length({ from_ns, to_ns }: TimeSpan): number {
  return Math.max(1, to_ns - from_ns);
}
