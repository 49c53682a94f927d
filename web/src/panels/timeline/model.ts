/** What the time line of a run remembers: the part that shows, folded lanes, the search and where one stands in it, what the pointer
 * is at. Belongs to the run as this page watches it. */

import { type Signal, signal } from "@preact/signals-core";
import type { Moment } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { type Calls, callsOf, NONE } from "../../store/history/calls.ts";
import { type Lane, lanesOf } from "../../store/history/lanes.ts";
import { hasTime, shownIndex, showTime } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { SeenBar, SeenLane } from "../../store/history/seen.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import type { Page } from "../../store/page/page.ts";
import { RefusalError } from "../../store/page/server.ts";
import { progressAt } from "../../store/run/progress.ts";
import { RunSearch } from "../../store/run/search.ts";
import type { NameOf } from "../parts/happened.ts";
import { lanesIn, layoutOf, type TimelineLayout } from "./layout.ts";
import { Overviews } from "./overviews.ts";
import { fitted, type SpanRequest, spanOf, type TimeSpan, withTime, zoomed } from "./span.ts";

/** What the pointer is at. */
export interface Pointed {
  /** In the rows' canvas, in CSS pixels. */
  readonly x: number;
  readonly y: number;
  readonly t_ns: number;
  /** The call there; null between calls. */
  readonly call: number | null;
  /** What the server says of it, where the call is not here. */
  readonly seen: SeenBar | null;
  /** How many calls lie together there, and how many of them failed. */
  readonly many: number;
  readonly failed: number;
}

export class TimelineModel {
  readonly watch: Watch;
  readonly spanRequest: Signal<SpanRequest> = signal<SpanRequest>(null);
  readonly folded: Signal<ReadonlySet<string>> = signal<ReadonlySet<string>>(new Set());
  /** Whether only branches show that ran in the part of time that shows. */
  readonly isOnlyInSight = signal(false);
  readonly found: Signal<RunSearch | null> = signal<RunSearch | null>(null);
  readonly query = signal("");
  /** The number of the event that the search stands at. */
  readonly hit: Signal<number | null> = signal<number | null>(null);
  readonly pointed: Signal<Pointed | null> = signal<Pointed | null>(null);

  readonly overviews: Overviews;
  readonly #page: Pick<Page, "server" | "runs">;
  /** A time whose moment is asked for. */
  readonly #asked_ns: Signal<number | null> = signal<number | null>(null);
  #isAsking = false;

  constructor(page: Pick<Page, "server" | "runs">, watch: Watch) {
    this.#page = page;
    this.watch = watch;
    this.overviews = new Overviews((what) => page.runs.get(watch.id, what));
  }

  /** The calls around the moment that is shown. */
  get calls(): Calls {
    return callsOf(this.watch.window);
  }

  /** Whether all that happened in the part of time that shows is here; else the server draws it. A signal's reader. */
  get isHere(): boolean {
    this.watch.journalVersion.value;
    const { watch, span, told_ns } = this;
    const { journal, window } = watch;
    if (window === journal && journal.base === null) return true;
    const isBegun = hasTime(watch, window, span.from_ns);
    const isWhole = window === journal || hasTime(watch, window, Math.min(span.to_ns, told_ns));
    return isBegun && isWhole;
  }

  /** The time of the moment that is shown; null: live. */
  get shown_ns(): number | null {
    const playhead = this.watch.playhead.value;
    if (this.#asked_ns.value !== null) return this.#asked_ns.value;
    if (playhead === null) return null;
    const { window, playheadSnapshot } = this.watch;
    if (window.base === null || window.covers(playhead)) return window.t_ns(shownIndex(this.watch));
    return playheadSnapshot.value?.picture.t_ns ?? null;
  }

  /** Shows the moment at a time; where that is not here it is asked for. */
  showTime(t_ns: number): void {
    if (showTime(this.watch, t_ns)) {
      this.#asked_ns.value = null;
      return;
    }
    this.#asked_ns.value = t_ns;
    void this.#askTime();
  }

  async #askTime(): Promise<void> {
    if (this.#isAsking) return;
    this.#isAsking = true;
    for (let at = this.#asked_ns.peek(); at !== null; at = this.#asked_ns.peek()) {
      try {
        const what = `moments?t_ns=${Math.max(0, Math.round(at))}`;
        const { sequence } = await this.#page.runs.get<Moment>(this.watch.id, what);
        if (this.#asked_ns.peek() === null) break;
        this.watch.playhead.value = Math.max(1, sequence);
        if (this.#asked_ns.peek() === at) this.#asked_ns.value = null;
      } catch (error) {
        if (!(error instanceof RefusalError)) throw error;
        this.#asked_ns.value = null;
      }
    }
    this.#isAsking = false;
  }

  /** Shows the moment after an event, or what is now. */
  show(sequence: number | null): void {
    this.#asked_ns.value = null;
    this.watch.playhead.value = sequence;
  }

  /** How far the run has come. While it goes on, another number once a second. A signal's reader. */
  get end_ns(): number {
    const isLive = this.watch.now.value?.run.phase === "live";
    return progressAt(this.#page, this.watch, isLive ? clock1s.value : 0) * 1e6;
  }

  /** When the last event was: after it nothing has changed. */
  get told_ns(): number {
    const { journal } = this.watch;
    return journal.length > 0 ? journal.t_ns(journal.length - 1) : 0;
  }

  get span(): TimeSpan {
    return spanOf(this.spanRequest.value, this.end_ns);
  }

  /** Where lanes and rows stand. */
  get layout(): TimelineLayout {
    const { calls } = this;
    const seen = this.isHere ? null : this.overviews.best(this.span);
    const all: readonly (Lane | SeenLane)[] = seen?.lanes ?? lanesOf(calls).all();
    const lanes = this.isOnlyInSight.value ? lanesIn(calls, all, this.span) : all;
    return layoutOf(lanes, this.folded.value);
  }

  /** Around the moment that is shown; live, at the end. */
  zoom(factor: number): void {
    const { span, end_ns } = this;
    const at = this.shown_ns ?? end_ns;
    const isInSight = at >= span.from_ns && at <= span.to_ns;
    const middle = (span.from_ns + span.to_ns) / 2;
    this.spanRequest.value = zoomed(span, factor, isInSight ? at : middle, end_ns);
  }

  fit(): void {
    this.spanRequest.value = null;
  }

  /** Shows the call of a state at the moment, else its last one; false if it never ran. */
  fitState(path: string): boolean {
    const { calls, end_ns } = this;
    const all = calls.of(path);
    const shown = this.watch.playhead.value === null ? calls.read : shownIndex(this.watch);
    const call = all.findLast((each) => calls.begin(each) <= shown) ?? all.at(-1) ?? NONE;
    if (call === NONE) return false;
    const part = { from_ns: calls.began_ns(call), to_ns: calls.ended_ns(call, end_ns) };
    this.spanRequest.value = fitted(part, end_ns);
    return true;
  }

  /** Brings the moment that is shown into sight. */
  reveal(): void {
    const t_ns = this.shown_ns;
    if (t_ns === null) return;
    this.spanRequest.value = withTime(this.spanRequest.value, t_ns, this.end_ns);
  }

  fold(path: string): void {
    const folded = new Set(this.folded.value);
    if (!folded.delete(path)) folded.add(path);
    this.folded.value = folded;
  }

  search(query: string, nameOf: NameOf): void {
    this.query.value = query;
    this.hit.value = null;
    this.found.value?.end();
    if (query.trim() === "") {
      this.found.value = null;
      return;
    }
    this.found.value = new RunSearch(this.watch, this.#page.runs, query, nameOf);
  }

  /** Goes to the next hit after the moment that is shown, or the one before, around the ends. */
  toHit(direction: "before" | "after"): void {
    const found = this.found.value;
    if (!found || found.count === 0) return;
    const playhead = this.watch.playhead.value;
    const from = this.hit.value ?? (playhead === null ? 0 : playhead - 1);
    const place = direction === "after" ? found.after(from) : found.before(from);
    const hit = found.sequence(place);
    this.hit.value = hit;
    this.show(hit);
    this.spanRequest.value = withTime(this.spanRequest.value, found.t_ns(place), this.end_ns);
  }
}

export const timelineOf = perOwner(
  (watch: Watch, page: Pick<Page, "server" | "runs">) => new TimelineModel(page, watch),
);
