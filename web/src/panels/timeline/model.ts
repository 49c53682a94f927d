/** What the time line of a run remembers: the part that shows, folded lanes, the search and where one stands in it, what the pointer
 * is at. Belongs to the run as this page watches it. */

import { type Signal, signal } from "@preact/signals-core";
import { perOwner } from "../../model/per_owner.ts";
import { type Calls, callsOf, NONE } from "../../store/history/calls.ts";
import { JournalHits } from "../../store/history/journal_hits.ts";
import { lanesOf } from "../../store/history/lanes.ts";
import { showIndex, shownIndex } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import type { Page } from "../../store/page/page.ts";
import { progressAt } from "../../store/run/progress.ts";
import type { NameOf } from "../parts/happened.ts";
import { lanesIn, layoutOf, type TimelineLayout } from "./layout.ts";
import { fitted, type SpanRequest, spanOf, type TimeSpan, withTime, zoomed } from "./span.ts";

/** What the pointer is at. */
export interface Pointed {
  /** In the rows' canvas, in CSS pixels. */
  readonly x: number;
  readonly y: number;
  readonly t_ns: number;
  /** The call there; null between calls. */
  readonly call: number | null;
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
  readonly found: Signal<JournalHits | null> = signal<JournalHits | null>(null);
  readonly query = signal("");
  /** The event of the journal that the search stands at. */
  readonly hit: Signal<number | null> = signal<number | null>(null);
  readonly pointed: Signal<Pointed | null> = signal<Pointed | null>(null);

  readonly #page: Pick<Page, "server">;

  constructor(page: Pick<Page, "server">, watch: Watch) {
    this.#page = page;
    this.watch = watch;
  }

  get calls(): Calls {
    return callsOf(this.watch.journal);
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

  /** The index of the event that is shown; null: live. */
  get shown(): number | null {
    return this.watch.playhead.value === null ? null : shownIndex(this.watch);
  }

  /** Where lanes and rows stand. */
  get layout(): TimelineLayout {
    const { calls } = this;
    const all = lanesOf(calls).all();
    const lanes = this.isOnlyInSight.value ? lanesIn(calls, all, this.span) : all;
    return layoutOf(lanes, this.folded.value);
  }

  /** Around the moment that is shown; live, at the end. */
  zoom(factor: number): void {
    const { span, end_ns } = this;
    const shown = this.shown;
    const at = shown === null ? end_ns : this.watch.journal.t_ns(shown);
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
    const shown = this.shown ?? calls.read;
    const call = all.findLast((each) => calls.begin(each) <= shown) ?? all.at(-1) ?? NONE;
    if (call === NONE) return false;
    const part = { from_ns: calls.began_ns(call), to_ns: calls.ended_ns(call, end_ns) };
    this.spanRequest.value = fitted(part, end_ns);
    return true;
  }

  /** Brings the moment that is shown into sight. */
  reveal(): void {
    const shown = this.shown;
    if (shown === null) return;
    const t_ns = this.watch.journal.t_ns(shown);
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
    if (query.trim() === "") {
      this.found.value = null;
      return;
    }
    const found = new JournalHits(this.watch.journal, query, nameOf);
    found.follow();
    this.found.value = found;
  }

  /** Goes to the next hit after the moment that is shown, or the one before, around the ends. */
  toHit(direction: "before" | "after"): void {
    const found = this.found.value;
    if (!found || found.hits.length === 0) return;
    const from = this.hit.value ?? (this.shown === null ? -1 : this.shown - 1);
    const place = direction === "after" ? found.after(from) : found.before(from);
    const hit = found.hits[place];
    if (hit === undefined) return;
    this.hit.value = hit;
    showIndex(this.watch, hit);
    this.reveal();
  }
}

export const timelineOf = perOwner(
  (watch: Watch, page: Pick<Page, "server">) => new TimelineModel(page, watch),
);
