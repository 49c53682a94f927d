/** Active branches, one row each. Those that need a person come first. A row has the duration compared with earlier runs, the
 * state that ended before, and buttons to step only this branch. */

import { ArrowDownToLine, ArrowRightToLine, ArrowUpFromLine, Undo2 } from "lucide-react";
import { useMemo } from "react";
import { namesTo } from "../../model/machine.ts";
import { holdInWords, isLive } from "../../model/run_words.ts";
import { lastEndBeside } from "../../store/history/last_end.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { type Active, activeStates, lanes, placeOfLane } from "../../store/run/active.ts";
import { type Baseline, baselineOf, usualInWords } from "../../store/run/baseline.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useCommand, useHost } from "../context.tsx";
import { AsOf } from "../parts/as_of.tsx";
import { comesNext, inOrder, PHASES, phaseInWords, toneOf } from "../parts/branch.ts";
import { duration, growing } from "../parts/duration.ts";
import { forRun, type RunPanelProps } from "../parts/for_tab.tsx";
import { reveal } from "../reveal.ts";
import { useSinceSnapshot } from "../since_snapshot.ts";
import "./running.css";

const NO_PAST: ReadonlyMap<string, Baseline> = new Map();
/** Maximum number of rows; further branches are only counted. */
const ROWS_MAX = 60;

export const Running = forRun(RunningOfRun, "Active states appear here, one row per branch.");

function RunningOfRun({ tab, watch }: RunPanelProps) {
  const shown = useComputed(() => inOrder(lanes(activeStates(watch))), [watch]);
  const playhead = useSignal(watch.playhead);
  const sinceSnapshot_ms = useSinceSnapshot(watch);
  if (shown.length === 0) return <Nothing watch={watch} />;
  return (
    <div className="running shows-run">
      <p className="running-count" role="status">
        {shown.length === 1 ? "1 branch" : `${shown.length} branches`}
        {playhead === null ? <AsOf watch={watch} /> : ` at event ${playhead.toLocaleString("en")}`}
      </p>
      <ul className="running-rows" aria-label="Active now">
        {shown.slice(0, ROWS_MAX).map((lane) => (
          <Row
            key={lane.branch}
            tab={tab}
            watch={watch}
            lane={lane}
            sinceSnapshot_ms={sinceSnapshot_ms}
            isLive={playhead === null}
          />
        ))}
      </ul>
      {shown.length > ROWS_MAX && (
        <p className="running-count">and {shown.length - ROWS_MAX} more</p>
      )}
    </div>
  );
}

function Nothing({ watch }: { readonly watch: Watch }) {
  const phase = useComputed(() => watch.now.value?.run.phase ?? "starting", [watch]);
  const isUnknown = useComputed(() => {
    const now = watch.now.value;
    return now?.link === "silent" && now.snapshot === null;
  }, [watch]);
  if (isUnknown) {
    return <Empty title="Not known yet" text="Active states appear once the robot responds." />;
  }
  const text = isLive(phase)
    ? "The run has not entered its first state."
    : "The run has ended. Its timeline shows what ran at any moment.";
  return <Empty title="Nothing is running" text={text} />;
}

interface BranchRowProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
  readonly lane: Active;
  readonly sinceSnapshot_ms: number;
  readonly isLive: boolean;
}

function Row({ tab, watch, lane, sinceSnapshot_ms, isLive }: BranchRowProps) {
  const host = useHost();
  const place = placeOfLane(lane);
  const { Icon } = PHASES[lane.phase];
  const around = namesTo(tab.session.machine, place).slice(1);
  const name = around.pop() ?? lane.name;
  return (
    <li className={`running-row running-phase-${lane.phase}`}>
      <button
        type="button"
        className="running-main"
        title={`${[...around, name].join(" › ")}: show it on the canvas`}
        onClick={() => reveal(host, { kind: "state", path: place })}
      >
        <Icon size={16} aria-hidden className="running-sign" />
        <span className="running-name">{name}</span>
        {!comesNext(lane) && (
          <span className="running-time">{growing(lane.since_ms + sinceSnapshot_ms)}</span>
        )}
        {around.length > 0 && <span className="running-way">{around.join(" › ")}</span>}
        <span className="running-words">
          {phaseInWords(lane, heldInWords)}
          {lane.phase !== "held" && <Against watch={watch} path={lane.path} />}
        </span>
        <Before watch={watch} path={place} tab={tab} />
      </button>
      {isLive && lane.phase === "held" && <Steps branch={lane.branch} name={name} />}
    </li>
  );
}

function heldInWords(by: Parameters<typeof holdInWords>[0], isBefore: boolean): string {
  return isBefore ? `comes next, ${holdInWords(by)}` : holdInWords(by);
}

function Against({ watch, path }: { readonly watch: Watch; readonly path: string }) {
  const usual = useComputed(() => {
    watch.journalVersion.value;
    const found = baselineOf(watch, NO_PAST, path);
    return found ? usualInWords(found, duration) : "";
  }, [watch, path]);
  return usual === "" ? null : <span className="running-soft"> · {usual}</span>;
}

function Before({
  watch,
  path,
  tab,
}: {
  readonly watch: Watch;
  readonly path: string;
  readonly tab: OpenTab;
}) {
  const last = useComputed(() => lastEndBeside(watch, path), [watch, path]);
  if (!last) return null;
  const tone = toneOf(last.outcome);
  return (
    <span className="running-before">
      before: {namesTo(tab.session.machine, last.path).at(-1)}
      <span className={tone && `running-${tone}`}> → {last.outcome.name}</span>
    </span>
  );
}

const STEPS = [
  ["run.back", "Step back", Undo2],
  ["run.into", "Step into", ArrowDownToLine],
  ["run.over", "Step over", ArrowRightToLine],
  ["run.out", "Step out", ArrowUpFromLine],
] as const;

/** The root's branch has no other beside it, so its buttons step without a branch argument. */
function Steps({ branch, name }: { readonly branch: string; readonly name: string }) {
  const run = useCommand();
  const argument = useMemo(() => (branch === "" ? undefined : branch), [branch]);
  return (
    <div className="running-steps" role="toolbar" aria-label={`Step the branch at ${name}`}>
      {STEPS.map(([id, title, Icon]) => (
        <IconButton
          key={id}
          label={`${title}: ${name}`}
          icon={<Icon size={15} />}
          onClick={() => run(id, argument)}
        />
      ))}
    </div>
  );
}
