/** State of the timeline of a run: the visible span, folded lanes, the search with its current hit, and the hovered position. It
 * belongs to the watched run. */

import { type Signal, signal } from "@preact/signals-core";
import type { Moment } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { type Calls, callsOf, NONE } from "../../store/history/calls.ts";
import { type Lane, lanesOf } from "../../store/history/lanes.ts";
import { hasTime, shownIndex, showTime } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { SeenBar, SeenLane } from "../../store/history/seen.ts";
import { LatestRequest } from "../../store/page/latest_request.ts";
import type { Page } from "../../store/page/page.ts";
import { extent_ns } from "../../store/run/data_end.ts";
import { RunSearch } from "../../store/run/search.ts";
import type { NameOf } from "../parts/happened.ts";
import { lanesIn, layoutOf, type TimelineLayout } from "./layout.ts";
import { Overviews } from "./overviews.ts";
import { fitted, type SpanRequest, spanOf, type TimeSpan, withTime, zoomed } from "./span.ts";

/** Hovered position of the chart. */
export interface Pointed {
  /** Position in the canvas of the rows, in CSS pixels. */
  readonly x: number;
  readonly y: number;
  readonly t_ns: number;
  /** Hovered call; null between calls. */
  readonly call: number | null;
  /** Data from the server, for calls that are not loaded. */
  readonly seen: SeenBar | null;
  /** Number of merged calls at the position, and of failures among them. */
  readonly many: number;
  readonly failed: number;
}

export class TimelineModel {
  readonly watch: Watch;
  readonly spanRequest: Signal<SpanRequest> = signal<SpanRequest>(null);
  readonly folded: Signal<ReadonlySet<string>> = signal<ReadonlySet<string>>(new Set());
  /** True to show only branches that were active in the visible span. */
  readonly isOnlyInSight = signal(false);
  readonly found: Signal<RunSearch | null> = signal<RunSearch | null>(null);
  readonly query = signal("");
  /** Sequence number of the current hit. */
  readonly hit: Signal<number | null> = signal<number | null>(null);
  readonly pointed: Signal<Pointed | null> = signal<Pointed | null>(null);

  readonly overviews: Overviews;
  readonly #page: Pick<Page, "server" | "runs">;
  /** Requested time of a moment that is not loaded yet. */
  readonly #asked_ns: Signal<number | null> = signal<number | null>(null);
  readonly #moment: LatestRequest<number, Moment>;

  constructor(page: Pick<Page, "server" | "runs">, watch: Watch) {
    this.#page = page;
    this.watch = watch;
    const found = ({ sequence }: Moment) => {
      if (this.#asked_ns.peek() !== null) watch.playhead.value = Math.max(1, sequence);
    };
    this.#moment = new LatestRequest({
      ask: (t_ns) => page.runs.get(watch.id, `moments?t_ns=${Math.max(0, Math.round(t_ns))}`),
      take: (moment) => {
        found(moment);
        this.#asked_ns.value = null;
      },
      takeEarlier: found,
      refused: () => {
        this.#asked_ns.value = null;
      },
      isRepeated: () => false,
    });
    this.overviews = new Overviews((what) => page.runs.get(watch.id, what));
  }

  /** Calls around the shown moment. */
  get calls(): Calls {
    return callsOf(this.watch.window);
  }

  /** True if all events of the visible span are loaded; otherwise the server draws it. Reads a signal. */
  get isHere(): boolean {
    this.watch.journalVersion.value;
    const { watch, span, lastEvent_ns } = this;
    const { journal, window } = watch;
    if (window === journal && journal.base === null) return true;
    const isBegun = hasTime(watch, window, span.from_ns);
    const isWhole =
      window === journal || hasTime(watch, window, Math.min(span.to_ns, lastEvent_ns));
    return isBegun && isWhole;
  }

  /** Time of the shown moment; null while live. */
  get shown_ns(): number | null {
    const playhead = this.watch.playhead.value;
    if (this.#asked_ns.value !== null) return this.#asked_ns.value;
    if (playhead === null) return null;
    const { window, playheadSnapshot } = this.watch;
    if (window.base === null || window.covers(playhead)) return window.t_ns(shownIndex(this.watch));
    return playheadSnapshot.value?.picture.t_ns ?? null;
  }

  /** Shows the moment at a time, and loads it if necessary. */
  showTime(t_ns: number): void {
    if (showTime(this.watch, t_ns)) {
      this.#asked_ns.value = null;
      this.#moment.drop();
      return;
    }
    this.#asked_ns.value = t_ns;
    this.#moment.want(t_ns);
  }

  /** Shows the moment after an event; null shows the live run. */
  show(sequence: number | null): void {
    this.#asked_ns.value = null;
    this.#moment.drop();
    this.watch.playhead.value = sequence;
  }

  /** Current length of the run in ns, updated with each confirmation while it is active. Reads signals. */
  get end_ns(): number {
    return extent_ns(this.#page, this.watch);
  }

  /** Time of the last event, after which nothing has changed. */
  get lastEvent_ns(): number {
    const { journal } = this.watch;
    return journal.length > 0 ? journal.t_ns(journal.length - 1) : 0;
  }

  get span(): TimeSpan {
    return spanOf(this.spanRequest.value, this.end_ns);
  }

  /** Positions of lanes and rows. */
  get layout(): TimelineLayout {
    const { calls } = this;
    const seen = this.isHere ? null : this.overviews.best(this.span);
    const all: readonly (Lane | SeenLane)[] = seen?.lanes ?? lanesOf(calls).all();
    const lanes = this.isOnlyInSight.value ? lanesIn(calls, all, this.span) : all;
    return layoutOf(lanes, this.folded.value);
  }

  /** Zooms around the shown moment or, while live, around the end. If that is not visible, around the middle. */
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

  /** Shows the call of a state at the moment, or else its last call; false if the state never ran. */
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

  /** Moves the shown moment into view. */
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

  /** Shows the next or previous hit relative to the current one. After the last hit it continues with the first. */
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
