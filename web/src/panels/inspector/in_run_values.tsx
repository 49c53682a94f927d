/** Values of a state in a run, each with the moment and the state that it came from. */

import { computed } from "@preact/signals-core";
import { Clock, Eye } from "lucide-react";
import { useMemo } from "react";
import type { PortKind } from "../../model/machine.ts";
import { portsOf } from "../../model/machine.ts";
import { type Origin, originOf } from "../../store/history/origin.ts";
import type { Watch } from "../../store/history/run.ts";
import { visitsOf } from "../../store/history/visits.ts";
import { runTime, timeScale } from "../../store/page/times.ts";
import type { StateStatus, Values } from "../../store/run/state_status.ts";
import {
  addWatched,
  isSameTarget,
  removeWatched,
  type Target,
  watchedOf,
} from "../../store/run/watched_values.ts";
import { IconButton } from "../../ui/button.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { dragValue } from "../parts/value/dragged_value.ts";
import { OnRobotValue } from "../parts/value/on_robot.tsx";
import type { Detailed } from "../parts/value/use_detail.ts";
import { ValueView } from "../parts/value/value_view.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { type RunGroup, runGroups } from "./run_groups.ts";

interface RunValuesProps {
  readonly inspected: InspectedState;
  readonly watch: Watch;
  readonly status: StateStatus;
  /** Last entry and last end with their values, if the snapshot of the moment does not contain these. */
  readonly entry: Detailed;
  readonly end: Detailed;
}

export function RunValues({ inspected, watch, status, entry, end }: RunValuesProps) {
  return runGroups(status, entry, end).map((group) => (
    <Group key={group.kind} inspected={inspected} watch={watch} {...group} />
  ));
}

interface GlobalValuesProps {
  readonly inspected: InspectedState;
  readonly watch: Watch;
  readonly values: Values;
}

export function GlobalValues({ inspected, watch, values }: GlobalValuesProps) {
  return Object.keys(values)
    .sort()
    .map((name) => (
      <Line
        key={name}
        inspected={inspected}
        watch={watch}
        target={{ kind: "global", path: "", name }}
        value={values[name]}
        origin={null}
        from={null}
      />
    ));
}

interface ValueGroupProps extends RunGroup {
  readonly inspected: InspectedState;
  readonly watch: Watch;
}

function Group({ inspected, watch, until, kind, title, values, refusal }: ValueGroupProps) {
  if (values === undefined) {
    return refusal === null ? null : (
      <p className="inspector-none">
        {title}: {refusal}
      </p>
    );
  }
  if (values === null) return <p className="inspector-none">{title} were not kept.</p>;
  const names = Object.keys(values);
  const [first] = names;
  if (first === undefined) return null;
  const origins = names.map((name) => originAt(inspected, watch, kind, name, until));
  const shared = isOne(origins) ? origins[0] : null;
  const what = names.length === 1 ? first : title.toLowerCase();
  return (
    <section className="in-run-group" aria-label={`${title} in the run`}>
      <div className="in-run-head">
        <h4>{title}</h4>
        {shared && <From inspected={inspected} watch={watch} what={what} origin={shared} />}
      </div>
      {names.map((name, index) => (
        <Line
          key={name}
          inspected={inspected}
          watch={watch}
          target={{ kind, path: inspected.path, name }}
          value={values[name]}
          origin={shared ? null : (origins[index] ?? null)}
          from={origins[index]?.sequence ?? null}
        />
      ))}
    </section>
  );
}

/** True if all values come from one event of one state. */
function isOne([first, ...others]: readonly (Origin | null)[]): boolean {
  return others.every((each) => each?.sequence === first?.sequence && each?.path === first?.path);
}

function originAt(
  { machine, path, state }: InspectedState,
  watch: Watch,
  kind: PortKind,
  name: string,
  until: number | null,
): Origin | null {
  const port = portsOf(state, kind).find((each) => each.name === name);
  return port ? originOf(machine, visitsOf(watch), { kind, path, id: port.id }, until) : null;
}

interface ValueLineProps {
  readonly inspected: InspectedState;
  readonly watch: Watch;
  readonly target: Target;
  readonly value: unknown;
  readonly origin: Origin | null;
  /** Event of the value; null if unknown. */
  readonly from: number | null;
}

function Line({ inspected, watch, target, value, origin, from }: ValueLineProps) {
  const isOfRobot = useComputed(() => (watch.now.value?.run.robot ?? null) !== null, [watch]);
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: dragging does what the button beside it does
    <div className="in-run-value" draggable onDragStart={(event) => dragValue(event, target)}>
      <ValueView
        name={target.name}
        value={value}
        keep={`${target.path} ${target.kind} ${target.name}`}
        actions={<WatchButton inspected={inspected} target={target} />}
      />
      {isOfRobot && (
        <OnRobotValue page={inspected.page} watch={watch} sequence={from} name={target.name} />
      )}
      {origin && (
        <div className="in-run-origin">
          <From inspected={inspected} watch={watch} what={target.name} origin={origin} />
        </div>
      )}
    </div>
  );
}

/** Starts or stops watching the value. */
function WatchButton({ inspected, target }: { inspected: InspectedState; target: Target }) {
  const { tab, page } = inspected;
  const all = useSignal(useMemo(() => computed(() => watchedOf(tab).value), [tab]));
  const here = all.filter((each) => isSameTarget(each.target, target));
  const toggle = () => {
    for (const { id } of here) removeWatched(tab, id);
    if (here.length > 0) return;
    addWatched(tab, target);
    if (all.length > 0) return;
    const action = { title: "Show watches", command: "view.panel", argument: "watches" } as const;
    page.tell({ level: "info", text: `${target.name} is watched.`, action });
  };
  return (
    <IconButton
      className="inspector-mini"
      label={`Watch ${target.name}`}
      icon={<Eye size={13} />}
      pressed={here.length > 0}
      onClick={toggle}
    />
  );
}

interface FromProps extends Pick<ValueLineProps, "inspected" | "watch"> {
  /** Subject of the sentence. */
  readonly what: string;
  readonly origin: Origin;
}

/** Event that set the value, with its time and the state that sent it. */
function From({ inspected, watch, what, origin }: FromProps) {
  useSignal(timeScale);
  const t_ns = watch.window.timeOf(origin.sequence);
  const name = inspected.machine.state(origin.path)?.name ?? origin.path;
  const isOwn = origin.path === inspected.path;
  return (
    <>
      <span className="in-run-when">
        #{origin.sequence}
        {t_ns === null ? "" : ` at ${runTime(watch, t_ns)}`}
        {isOwn ? "" : " by "}
        {!isOwn && (
          <button
            type="button"
            className="inspector-link"
            onClick={() => inspected.show({ kind: "state", path: origin.path })}
          >
            {name}
          </button>
        )}
      </span>
      <IconButton
        className="inspector-mini"
        label={`Show the moment when ${what} was set`}
        icon={<Clock size={13} />}
        onClick={() => {
          watch.playhead.value = origin.seen;
        }}
      />
    </>
  );
}
