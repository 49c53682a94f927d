/** Timeline of the current run: one lane per branch with its states as bars, and the shown moment, which pointer and keys move. */

import { signal } from "@preact/signals-core";
import {
  ChevronDown,
  ChevronRight,
  ChevronUp,
  Crosshair,
  ListFilter,
  Maximize2,
  Radio,
  ZoomIn,
  ZoomOut,
} from "lucide-react";
import { useEffect, useRef } from "react";
import { shownIndex, toEnd } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { selectedStates } from "../../store/page/view.ts";
import { gapsOf, lackingOf } from "../../store/run/gaps.ts";
import type { RunSearch } from "../../store/run/search.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { duration } from "../parts/duration.ts";
import { forRun, type RunPanelProps } from "../parts/for_tab.tsx";
import { namesOf } from "../parts/happened.ts";
import { useMoment } from "../parts/moment_words.ts";
import { partedAt } from "../parts/parted.ts";
import { reveal } from "../reveal.ts";
import { useRunAge } from "../run_age.ts";
import { mountChart } from "./chart.ts";
import { timelineKey } from "./keys.ts";
import { type TimelineModel, timelineOf } from "./model.ts";
import { Pointed } from "./pointed.tsx";
import "./timeline.css";

export const Timeline = forRun(
  TimelineOfRun,
  "Its states appear here over time, one lane per branch.",
  "Its runs appear here over time.",
);

interface TimelineProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
  readonly model: TimelineModel;
}

function TimelineOfRun({ tab, watch }: RunPanelProps) {
  const { page } = useHost().context();
  const model = timelineOf(watch, page);
  const { isOld } = useRunAge(page, watch);
  return (
    <section className={isOld ? "timeline is-old" : "timeline"} aria-label="Timeline">
      <Bar tab={tab} watch={watch} model={model} />
      <Chart tab={tab} watch={watch} model={model} />
    </section>
  );
}

function liveTitle(isLive: boolean, isOld: boolean): string {
  if (!isLive) return "Show the current state";
  return isOld ? "The page shows the last known state" : "The page shows the current state";
}

function Bar({ tab, watch, model }: TimelineProps) {
  const isLive = useSignal(watch.playhead) === null;
  const isOver = useSignal(watch.now)?.link === "over";
  const { page } = useHost().context();
  const { isOld, age_ms } = useRunAge(page, watch);
  const isOnlyInSight = useSignal(model.isOnlyInSight);
  useSignal(model.spanRequest);
  const [state] = useSelectedStates(tab);
  return (
    <div className="timeline-bar">
      <Button
        icon={<Radio size={14} />}
        kind={isLive ? "quiet" : "primary"}
        title={liveTitle(isLive, isOld)}
        pressed={isLive}
        onClick={() => toEnd(watch, "last")}
      >
        {isOver ? "End" : isOld && isLive ? `${duration(age_ms)} old` : "Live"}
      </Button>
      <Now tab={tab} watch={watch} />
      <span className="timeline-gap" />
      <SearchField tab={tab} model={model} />
      <span className="timeline-group">
        <IconButton
          label="Only branches active in this period"
          icon={<ListFilter size={15} />}
          pressed={isOnlyInSight}
          onClick={() => {
            model.isOnlyInSight.value = !isOnlyInSight;
          }}
        />
        <IconButton
          label="Zoom in on the timeline"
          keys="+"
          icon={<ZoomIn size={15} />}
          onClick={() => model.zoom(0.5)}
        />
        <IconButton
          label="Zoom out of the timeline"
          keys="-"
          icon={<ZoomOut size={15} />}
          onClick={() => model.zoom(2)}
        />
        <IconButton
          label="Fit the whole run"
          keys="F"
          icon={<Maximize2 size={15} />}
          onClick={() => model.fit()}
        />
        <IconButton
          label="Zoom to the selected state"
          keys="Z"
          icon={<Crosshair size={15} />}
          disabled={state === undefined}
          onClick={() => state !== undefined && model.fitState(state)}
        />
      </span>
    </div>
  );
}

function useSelectedStates(tab: OpenTab): readonly string[] {
  useSignal(tab.view.selection);
  return selectedStates(tab.view);
}

function Now({ tab, watch }: Pick<TimelineProps, "tab" | "watch">) {
  const { when, what } = useMoment(tab, watch);
  return (
    <span className="timeline-now" title={what}>
      <span className="timeline-when">{when}</span>
      <span className="timeline-what">{what}</span>
    </span>
  );
}

function SearchField({ tab, model }: Pick<TimelineProps, "tab" | "model">) {
  const query = useSignal(model.query);
  const found = useSignal(model.found);
  const hit = useSignal(model.hit);
  useSignal(model.watch.journalVersion);
  useSignal(found?.changed ?? NEVER);
  found?.follow();
  const many = found?.count ?? 0;
  const place = hit === null || !found ? 0 : found.after(hit - 1) + 1;
  return (
    <span className="timeline-group">
      <TextField
        label="Search the run: states, outcomes, log"
        hideLabel
        type="search"
        placeholder="State, outcome, text"
        value={query}
        onInput={(text) => model.search(text, namesOf(tab.session))}
        onKeyDown={(event) => {
          if (event.key === "Enter") model.toHit(event.shiftKey ? "before" : "after");
        }}
      />
      <span className="timeline-hits" role="status">
        {found && hitsInWords(found, place)}
      </span>
      <IconButton
        label="Previous hit"
        keys="Shift+Enter"
        icon={<ChevronUp size={15} />}
        disabled={many === 0}
        onClick={() => model.toHit("before")}
      />
      <IconButton
        label="Next hit"
        keys="Enter"
        icon={<ChevronDown size={15} />}
        disabled={many === 0}
        onClick={() => model.toHit("after")}
      />
    </span>
  );
}

const NEVER = signal(0);

/** Position of the current hit, as text. A place of 0 means that no hit was selected yet. */
function hitsInWords(found: RunSearch, place: number): string {
  const { count, isFull, isAsking, refusal } = found;
  if (count === 0 && refusal !== null) return refusal;
  if (count === 0) return isAsking ? "Searching…" : "No hits";
  const more = isFull ? "+" : isAsking ? "…" : "";
  return `${place === 0 ? "–" : inWords(place)} of ${inWords(count)}${more}`;
}

function inWords(count: number): string {
  return count.toLocaleString("en");
}

function Chart({ tab, watch, model }: TimelineProps) {
  const ruler = useRef<HTMLCanvasElement>(null);
  const rows = useRef<HTMLCanvasElement>(null);
  const scroller = useRef<HTMLDivElement>(null);
  const { page } = useHost().context();
  useEffect(() => {
    if (!ruler.current || !rows.current || !scroller.current) return;
    const places = { ruler: ruler.current, rows: rows.current, scroller: scroller.current };
    return mountChart(places, {
      tab,
      model,
      parted_ns: () => partedAt(watch),
      gaps: () => [...gapsOf(watch, page).value, ...lackingOf(watch)],
    });
  }, [tab, model, page, watch]);
  const { when, what } = useMoment(tab, watch);
  return (
    <>
      <div className="timeline-head">
        <div className="timeline-corner" aria-hidden>
          Branches
        </div>
        <canvas ref={ruler} className="timeline-ruler" aria-hidden />
      </div>
      <div ref={scroller} className="timeline-scroll">
        <Labels tab={tab} watch={watch} model={model} />
        <div className="timeline-rows">
          <canvas
            ref={rows}
            className="timeline-canvas"
            role="slider"
            tabIndex={0}
            aria-label="Moment of the run"
            aria-valuemin={0}
            aria-valuemax={watch.journal.sequence(watch.journal.length - 1)}
            aria-valuenow={watch.window.sequence(shownIndex(watch))}
            aria-valuetext={`${when} ${what}`}
            onKeyDown={(event) => {
              if (!timelineKey(event, model, selectedStates(tab.view)[0])) return;
              event.preventDefault();
              event.stopPropagation();
            }}
          />
          <Pointed tab={tab} model={model} />
        </div>
      </div>
    </>
  );
}

function Labels({ tab, watch, model }: TimelineProps) {
  const host = useHost();
  useSignal(model.folded);
  useSignal(model.isOnlyInSight);
  useSignal(model.spanRequest);
  useSignal(watch.journalVersion);
  useSignal(watch.playhead);
  useSignal(model.overviews.seen);
  useSignal(tab.session.version);
  const { layout } = model;
  const nameOf = namesOf(tab.session);
  return (
    <ul className="timeline-labels" aria-label="Branches" style={{ height: layout.height }}>
      {layout.lanes.map(({ lane, y, height, isFolded }) => (
        <li key={lane.path} style={{ top: y, height, paddingLeft: 2 + lane.depth * 12 }}>
          <button
            type="button"
            className="timeline-fold"
            aria-expanded={!isFolded}
            aria-label={`${isFolded ? "All levels" : "One row"} of ${nameOf(lane.path)}`}
            title={isFolded ? "Show all levels" : "Show only the innermost states, in one row"}
            onClick={() => model.fold(lane.path)}
          >
            {isFolded ? <ChevronRight size={13} /> : <ChevronDown size={13} />}
          </button>
          <button
            type="button"
            className="timeline-name"
            title={`${nameOf(lane.path)}: show it on the canvas`}
            onClick={() => reveal(host, { kind: "state", path: lane.path })}
          >
            {nameOf(lane.path)}
          </button>
        </li>
      ))}
    </ul>
  );
}
