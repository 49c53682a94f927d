/** The two canvases of the timeline: repaints them at most once per frame after changes, and handles the pointer. */

import { effect } from "@preact/signals-core";
import { inksOf, onTheme, scaledContext } from "../../store/canvas_element.ts";
import { NONE } from "../../store/history/calls.ts";
import { showIndex } from "../../store/history/moments.ts";
import { notesOf } from "../../store/history/notes.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime, timeScale } from "../../store/page/times.ts";
import { select, selectedStates } from "../../store/page/view.ts";
import type { Gap } from "../../store/run/gaps.ts";
import { namesOf } from "../parts/happened.ts";
import { barsOf, type Scale, timeAt, xOf } from "./bars.ts";
import { rowAt } from "./layout.ts";
import type { Pointed, TimelineModel } from "./model.ts";
import { paintRows, paintRuler, RULER_PX, type Scene } from "./paint.ts";
import { panned, zoomed } from "./span.ts";

interface ChartPlaces {
  readonly ruler: HTMLCanvasElement;
  readonly rows: HTMLCanvasElement;
  /** Element that scrolls the rows. */
  readonly scroller: HTMLElement;
}

interface ChartOptions {
  readonly tab: OpenTab;
  readonly model: TimelineModel;
  /** Time at which the shown run differs from the compared one. */
  readonly parted_ns: () => number | null;
  /** Times without data from the server. */
  readonly gaps: () => readonly Gap[];
}

/** Paints and listens until the returned function is called. */
export function mountChart(places: ChartPlaces, options: ChartOptions): () => void {
  const chart = new Chart(places, options);
  return () => chart.dispose();
}

/** Largest movement of a click, in CSS pixels. */
const CLICK_PX = 4;
/** Zoom factor per unit of the wheel. */
const WHEEL = 1.0016;
const OPAQUE = { alpha: false };

class Chart {
  readonly #places: ChartPlaces;
  readonly #options: ChartOptions;
  readonly #stops: (() => void)[];
  /** Colours and font while the canvas is in the document; null before they are read. */
  #style: Pick<Scene, "inks" | "font"> | null = null;
  #frame = 0;

  constructor(places: ChartPlaces, options: ChartOptions) {
    this.#places = places;
    this.#options = options;
    const follow = effect(() => {
      this.#read();
      this.#soon();
    });
    const theme = onTheme(() => {
      this.#style = null;
      this.#soon();
    });
    const resized = new ResizeObserver(() => this.#soon());
    resized.observe(places.scroller);
    const listening = new AbortController();
    this.#listen(listening.signal);
    this.#stops = [follow, theme, () => resized.disconnect(), () => listening.abort()];
  }

  dispose(): void {
    cancelAnimationFrame(this.#frame);
    for (const stop of this.#stops) stop();
  }

  /** Reads all signals that the picture depends on. */
  #read(): void {
    const { tab, model, parted_ns, gaps } = this.#options;
    gaps();
    model.watch.journalVersion.value;
    model.end_ns;
    model.watch.playhead.value;
    model.spanRequest.value;
    model.folded.value;
    model.isOnlyInSight.value;
    model.found.value;
    model.hit.value;
    model.pointed.value;
    model.overviews.seen.value;
    model.shown_ns;
    model.found.value?.changed.value;
    tab.view.selection.value;
    tab.session.version.value;
    timeScale.value;
    parted_ns();
  }

  #soon(): void {
    if (this.#frame === 0) this.#frame = requestAnimationFrame(() => this.#paint());
  }

  get #scale(): Scale {
    const { model } = this.#options;
    const width = Math.max(1, this.#places.rows.clientWidth);
    return { span: model.span, width, end_ns: model.end_ns };
  }

  #paint(): void {
    this.#frame = 0;
    const { ruler, rows, scroller } = this.#places;
    // A hidden panel has no size and no colours. It is painted when it becomes visible.
    if (!rows.isConnected) return;
    this.#style ??= { inks: inksOf(rows), font: getComputedStyle(rows).fontFamily };
    const { tab, model, parted_ns, gaps } = this.#options;
    const { calls } = model;
    const found = model.found.peek();
    found?.follow();
    const { span, width: wide } = this.#scale;
    if (!model.isHere) model.overviews.want(span, wide, model.watch.journal.next - 1);
    const scene: Scene = {
      calls,
      notes: notesOf(model.watch.journal),
      found,
      layout: model.layout,
      scale: this.#scale,
      top: scroller.scrollTop,
      height: scroller.clientHeight,
      shown_ns: model.shown_ns,
      hit: model.hit.peek(),
      selected: new Set(selectedStates(tab.view)),
      hovered: model.pointed.peek()?.call ?? null,
      parted_ns: parted_ns(),
      gaps: gaps(),
      nameOf: namesOf(tab.session),
      timeOf: (t_ns, step_ms) => runTime(model.watch, t_ns, step_ms),
      ...this.#style,
    };
    const { width } = scene.scale;
    const above = scaledContext(ruler, { width, height: RULER_PX }, OPAQUE);
    if (above) paintRuler(above, scene);
    // For tests that wait until the whole visible time is drawn.
    const isDrawn = model.isHere || model.overviews.seen.peek() !== null;
    if (rows.parentElement) rows.parentElement.dataset["drawn"] = isDrawn ? "whole" : "part";
    const below = scaledContext(rows, { width, height: scene.height }, OPAQUE);
    if (below) paintRows(below, scene);
  }

  #listen(signal: AbortSignal): void {
    const { ruler, rows, scroller } = this.#places;
    const passive = { signal, passive: false };
    for (const canvas of [ruler, rows]) {
      canvas.addEventListener("wheel", (event) => this.#wheel(event), passive);
    }
    scroller.addEventListener("scroll", () => this.#soon(), { signal });
    ruler.addEventListener("pointerdown", (event) => this.#scrub(event, true), { signal });
    ruler.addEventListener("pointermove", (event) => this.#scrub(event, false), { signal });
    rows.addEventListener("pointerdown", (event) => this.#press(event), { signal });
    rows.addEventListener("pointermove", (event) => this.#point(event), { signal });
    rows.addEventListener(
      "pointerleave",
      () => {
        this.#options.model.pointed.value = null;
      },
      { signal },
    );
  }

  /** Handles the wheel: vertical turns zoom, horizontal turns and Shift pan. Ctrl zooms as well. */
  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const { model } = this.#options;
    const { span, end_ns } = model;
    const scale = this.#scale;
    const by = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    const aside = event.shiftKey && event.deltaX === 0 ? event.deltaY : event.deltaX;
    if (Math.abs(aside) > Math.abs(event.shiftKey ? 0 : event.deltaY)) {
      const by_ns = ((aside * by) / scale.width) * (span.to_ns - span.from_ns);
      model.spanRequest.value = panned(span, by_ns, end_ns);
    } else {
      const factor = WHEEL ** (event.deltaY * by);
      model.spanRequest.value = zoomed(span, factor, timeAt(scale, event.offsetX), end_ns);
    }
  }

  #scrub(event: PointerEvent, isBegin: boolean): void {
    const { ruler } = this.#places;
    const { model } = this.#options;
    if (isBegin) ruler.setPointerCapture(event.pointerId);
    else if (!ruler.hasPointerCapture(event.pointerId)) return;
    const note = isBegin ? this.#noteAt(event) : null;
    if (note === null) this.#showAt(event.offsetX);
    else model.show(note);
  }

  /** Sequence number of the event with the pressed mark on the ruler. */
  #noteAt(event: PointerEvent): number | null {
    if (event.offsetY < RULER_PX / 2) return null;
    const { journal } = this.#options.model.watch;
    const scale = this.#scale;
    const notes = notesOf(journal);
    const t_ns = timeAt(scale, event.offsetX - CLICK_PX - 2);
    const note = notes.all[notes.firstFrom(journal.indexAt(t_ns))];
    if (!note) return null;
    const away = xOf(scale, journal.t_ns(note.index)) - event.offsetX;
    return Math.abs(away) <= CLICK_PX + 2 ? journal.sequence(note.index) : null;
  }

  /** Shows the moment at this position; the live run to the right of the last event. */
  #showAt(x: number): void {
    const { model } = this.#options;
    const t_ns = timeAt(this.#scale, x);
    if (t_ns >= model.lastEvent_ns) model.show(null);
    else model.showTime(t_ns);
  }

  #press(event: PointerEvent): void {
    if (event.button !== 0) return;
    const { rows } = this.#places;
    const { model } = this.#options;
    const [from, span] = [event.clientX, model.span];
    let isDrag = false;
    rows.setPointerCapture(event.pointerId);
    const listening = new AbortController();
    const { signal } = listening;
    const move = ({ clientX }: PointerEvent) => {
      isDrag ||= Math.abs(clientX - from) > CLICK_PX;
      if (!isDrag) return;
      const by_ns = ((from - clientX) / this.#scale.width) * (span.to_ns - span.from_ns);
      model.spanRequest.value = panned(span, by_ns, model.end_ns);
    };
    const up = (end: PointerEvent) => {
      listening.abort();
      if (!isDrag) this.#click(end);
    };
    rows.addEventListener("pointermove", move, { signal });
    rows.addEventListener("pointerup", up, { signal });
    rows.addEventListener("pointercancel", () => listening.abort(), { signal });
  }

  /** Shows the moment, and selects the state that was active there. */
  #click(event: PointerEvent): void {
    const { tab, model } = this.#options;
    const { calls } = model;
    const { call, seen } = this.#pointedAt(event);
    const isNow = timeAt(this.#scale, event.offsetX) >= model.lastEvent_ns;
    if (call === null || (isNow && calls.end(call) === NONE)) this.#showAt(event.offsetX);
    else this.#showIn(call, event.offsetX);
    const path = call === null ? seen?.path : calls.path(call);
    if (path !== undefined && tab.session.machine.state(path))
      select(tab.view, [{ kind: "state", path }]);
  }

  /** Shows a moment within a call, even if its bar is narrow. */
  #showIn(call: number, x: number): void {
    const { calls, watch } = this.#options.model;
    const [begin, end] = [calls.begin(call), calls.end(call)];
    const at = calls.journal.indexAt(timeAt(this.#scale, x) + 1) - 1;
    const last = end === NONE ? calls.read - 1 : end - 1;
    showIndex(watch, Math.min(Math.max(at, begin), Math.max(last, begin)));
  }

  #point(event: PointerEvent): void {
    this.#options.model.pointed.value = event.buttons === 0 ? this.#pointedAt(event) : null;
  }

  #pointedAt({ offsetX: x, offsetY: y }: PointerEvent): Pointed {
    const { model } = this.#options;
    const scale = this.#scale;
    const t_ns = timeAt(scale, x);
    const nothing = { x, y, t_ns, call: null, seen: null, many: 0, failed: 0 };
    const found = rowAt(model.layout, y + this.#places.scroller.scrollTop);
    if (!found) return nothing;
    const bar = barsOf(model.calls, found.row, scale).find(
      (each) => x >= each.x - 1 && x <= each.x + each.width + 1,
    );
    if (!bar) return nothing;
    if ("seen" in bar) {
      const { many, failed } = bar.seen;
      return { ...nothing, seen: bar.seen, many, failed };
    }
    return "many" in bar
      ? { ...nothing, call: bar.first, many: bar.many, failed: bar.failed }
      : { ...nothing, call: bar.call, many: 1 };
  }
}
