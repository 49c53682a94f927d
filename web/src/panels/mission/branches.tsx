/** Current activity: one card per active branch, with its state, its duration compared with earlier runs, and the state that
 * ended before. */

import { Play } from "lucide-react";
import { isLive, reasonOfHold } from "../../model/run_words.ts";
import { type LastEnd, lastEndBeside } from "../../store/history/last_end.ts";
import type { Watch } from "../../store/history/run.ts";
import { type Active, placeOfLane } from "../../store/run/active.ts";
import {
  type Baseline,
  baselineOf,
  earlierRuns,
  isLongerThanEver,
  pastBaselines,
  usualInWords,
} from "../../store/run/baseline.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useCommand, useHost, useRefusalOf } from "../context.tsx";
import { comesNext, PHASES, phaseInWords, toneOf } from "../parts/branch.ts";
import { duration, growing } from "../parts/duration.ts";
import { reveal } from "../reveal.ts";
import { useCalmLanes } from "./calm_lanes.ts";
import { type Names, pathInWords, useMachineNames } from "./names.ts";

/** Maximum number of cards; further branches are only counted. */
const CARDS_MAX = 12;

export function Branches({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const { all: shown, sinceSnapshot_ms } = useCalmLanes(page, watch);
  const names = useMachineNames();
  const past = useComputed(
    () => pastBaselines(page, earlierRuns(page, watch)[0]?.id ?? null).value,
    [page, watch],
  );
  const isPast = useComputed(() => watch.playhead.value !== null, [watch]);
  if (shown.length === 0) return <Nothing watch={watch} />;
  return (
    <section className="mission-part" aria-label={isPast ? "Active at this moment" : "Active now"}>
      <ul className={isPast ? "mission-cards mission-cards-past" : "mission-cards"}>
        {shown.slice(0, CARDS_MAX).map((lane) => (
          <Card
            key={lane.branch}
            lane={lane}
            names={names}
            last={lastEndBeside(watch, placeOfLane(lane))}
            baseline={baselineOf(watch, past, lane.path)}
            sinceSnapshot_ms={sinceSnapshot_ms}
          />
        ))}
      </ul>
      {shown.length > CARDS_MAX && (
        <p className="mission-soft">and {shown.length - CARDS_MAX} more branches</p>
      )}
    </section>
  );
}

/** Shown while no branch is active. After the end of a run it has a button to start another. */
function Nothing({ watch }: { readonly watch: Watch }) {
  const run = useCommand();
  const phase = useComputed(() => watch.now.value?.run.phase, [watch]);
  const isFar = useComputed(() => watch.now.value?.run.robot != null, [watch]);
  // The machine is on the robot and cannot be edited here.
  const command = isFar ? "run.start-again" : "run.start";
  const refusal = useRefusalOf(command);
  const isKnown = useComputed(() => watch.now.value?.snapshot != null, [watch]);
  if (isLive(phase)) {
    return (
      <section className="mission-part" aria-label="Active now">
        <p className="mission-soft">
          {isKnown ? "Nothing is running." : "Active states are not known yet."}
        </p>
      </section>
    );
  }
  if (phase === "crashed" || phase === "diverged" || phase === undefined) return null;
  return (
    <section className="mission-part mission-over" aria-label="The run has ended">
      <p>The run has ended.</p>
      <Button
        icon={<Play size={16} aria-hidden />}
        disabled={refusal !== null}
        onClick={() => run(command)}
      >
        {isFar ? "Start again…" : "Start again"}
      </Button>
      {refusal && <p className="mission-why">You cannot start it: {refusal}.</p>}
    </section>
  );
}

interface CardProps {
  readonly lane: Active;
  readonly names: Names;
  readonly last: LastEnd | null;
  readonly baseline: Baseline | null;
  readonly sinceSnapshot_ms: number;
}

function Card({ lane, names, last, baseline, sinceSnapshot_ms }: CardProps) {
  const host = useHost();
  const place = placeOfLane(lane);
  const since_ms = lane.since_ms + sinceSnapshot_ms;
  const isLong = baseline !== null && isLongerThanEver(lane, baseline, since_ms);
  const { Icon } = PHASES[lane.phase];
  const around = pathInWords(names, place).split(" › ");
  const name = around.pop() ?? lane.name;
  return (
    <li className={`mission-card shows-run mission-phase-${lane.phase}`}>
      <div className="mission-card-head">
        <p className="mission-card-way">{around.join(" › ")}</p>
        <p className="mission-card-phase">
          <Icon size={16} aria-hidden />
          <span>{phaseInWords(lane, heldInWords)}</span>
        </p>
      </div>
      <div className="mission-card-main">
        <button
          type="button"
          className="mission-card-name"
          title="Show it on the canvas"
          onClick={() => reveal(host, { kind: "state", path: place })}
        >
          {name}
        </button>
        {!comesNext(lane) && <span className="mission-card-time">{growing(since_ms)}</span>}
      </div>
      {lane.phase !== "held" && baseline && (
        <Bar baseline={baseline} since_ms={since_ms} isLong={isLong} />
      )}
      <div className="mission-card-foot">
        {lane.phase !== "held" && baseline && (
          <p className={isLong ? "mission-long" : undefined}>
            {isLong ? "longer than ever: " : ""}
            {usualInWords(baseline, duration)}
          </p>
        )}
        {last && <Before last={last} names={names} />}
      </div>
    </li>
  );
}

function heldInWords(by: Parameters<typeof reasonOfHold>[0], isBefore: boolean): string {
  const reason = reasonOfHold(by);
  return `paused${isBefore ? " before this state" : ""}${reason === "" ? "" : `: ${reason}`}`;
}

interface BranchBarProps {
  readonly baseline: Baseline;
  readonly since_ms: number;
  readonly isLong: boolean;
}

/** Bar of the time in the state, compared with the usual duration. */
function Bar({ baseline: { typical_ms, max_ms }, since_ms, isLong }: BranchBarProps) {
  const scale = Math.max(max_ms, since_ms, 1);
  const width = (ms: number) => ({ width: `${(ms / scale) * 100}%` });
  return (
    <span className={`mission-bar ${isLong ? "mission-bar-long" : ""}`} aria-hidden>
      <span className="mission-bar-now" style={width(since_ms)} />
      <span className="mission-bar-usual" style={width(typical_ms)} />
    </span>
  );
}

function Before({ last, names }: { readonly last: LastEnd; readonly names: Names }) {
  const tone = toneOf(last.outcome);
  return (
    <p className="mission-before">
      <span className="mission-soft">before: </span>
      {pathInWords(names, last.path).split(" › ").pop()}
      <span className={`mission-outcome ${tone && `mission-tone-${tone}`}`}>
        {" "}
        → {last.outcome.name}
      </span>
    </p>
  );
}
