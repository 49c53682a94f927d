/** The values of a state in a run: each with the moment at which it came there, and from where. */

import { computed } from "@preact/signals-core";
import { Clock, Eye } from "lucide-react";
import { useMemo } from "react";
import type { Event } from "../../model/generated/protocol.ts";
import type { PortKind } from "../../model/machine.ts";
import { portsOf } from "../../model/machine.ts";
import { type Origin, originOf } from "../../store/origin.ts";
import type { Watch } from "../../store/run.ts";
import type { Standing, Values } from "../../store/standing.ts";
import { visitsOf } from "../../store/visits.ts";
import {
  addWatched,
  isSameTarget,
  removeWatched,
  type Target,
  watchedOf,
} from "../../store/watched_values.ts";
import { IconButton } from "../../ui/button.tsx";
import { useSignal } from "../../ui/signals.ts";
import { sinceStart } from "../parts/duration.ts";
import { dragValue } from "../parts/value/dragged_value.ts";
import type { Detailed } from "../parts/value/use_detail.ts";
import { ValueView } from "../parts/value/value_view.tsx";
import type { SeenState } from "./seen.ts";

export interface RunValuesProps {
  readonly seen: SeenState;
  readonly watch: Watch;
  readonly standing: Standing;
  /** The last entry and the last end with their values, where the moment does not have them. */
  readonly entry: Detailed;
  readonly end: Detailed;
}

export function RunValues({ seen, watch, standing, entry, end }: RunValuesProps) {
  const inputs = standing.inputs === undefined ? valuesOf(entry, "inputs") : standing.inputs;
  const outputs = standing.outputs === undefined ? valuesOf(end, "outputs") : standing.outputs;
  const shared = { seen, watch, until: standing.until };
  const isAgain = standing.active && standing.left;
  return (
    <>
      <Group {...shared} kind="input" title="Inputs" values={inputs} refusal={entry.refusal} />
      {standing.left && (
        <Group
          {...shared}
          kind="output"
          title={isAgain ? "Outputs of its last end" : "Outputs"}
          values={outputs}
          refusal={end.refusal}
        />
      )}
      {standing.scoped && (
        <Group
          {...shared}
          kind="scoped_variable"
          title="Scoped variables"
          values={standing.scoped}
          refusal={null}
        />
      )}
    </>
  );
}

export interface GlobalValuesProps {
  readonly seen: SeenState;
  readonly watch: Watch;
  readonly values: Values;
}

export function GlobalValues({ seen, watch, values }: GlobalValuesProps) {
  return Object.keys(values)
    .sort()
    .map((name) => (
      <Line
        key={name}
        seen={seen}
        watch={watch}
        target={{ kind: "global", path: "", name }}
        value={values[name]}
        origin={null}
      />
    ));
}

/** Values of an event: null if they were not kept, undefined while it is on its way. */
function valuesOf({ detail }: Detailed, side: "inputs" | "outputs"): Values | null | undefined {
  if (!detail) return undefined;
  const event: Event = detail.event;
  if (side === "inputs") return event.type === "entered" ? (event.inputs ?? null) : undefined;
  return event.type === "left" ? (event.outputs ?? null) : undefined;
}

interface GroupProps {
  readonly seen: SeenState;
  readonly watch: Watch;
  readonly until: number | null;
  readonly kind: PortKind;
  readonly title: string;
  readonly values: Values | null | undefined;
  readonly refusal: string | null;
}

function Group({ seen, watch, until, kind, title, values, refusal }: GroupProps) {
  if (values === undefined) {
    return refusal === null ? null : (
      <p className="inspector-none">
        {title}: {refusal}
      </p>
    );
  }
  if (values === null) return <p className="inspector-none">{title} were not kept.</p>;
  const names = Object.keys(values);
  if (names.length === 0) return null;
  return (
    <section className="in-run-group" aria-label={`${title} in the run`}>
      <h4>{title}</h4>
      {names.map((name) => (
        <Line
          key={name}
          seen={seen}
          watch={watch}
          target={{ kind, path: seen.path, name }}
          value={values[name]}
          origin={originAt(seen, watch, kind, name, until)}
        />
      ))}
    </section>
  );
}

function originAt(
  { machine, path, state }: SeenState,
  watch: Watch,
  kind: PortKind,
  name: string,
  until: number | null,
): Origin | null {
  const port = portsOf(state, kind).find((each) => each.name === name);
  return port ? originOf(machine, visitsOf(watch), { kind, path, id: port.id }, until) : null;
}

interface LineProps {
  readonly seen: SeenState;
  readonly watch: Watch;
  readonly target: Target;
  readonly value: unknown;
  readonly origin: Origin | null;
}

function Line({ seen, watch, target, value, origin }: LineProps) {
  const eye = <WatchButton seen={seen} target={target} />;
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: dragging does what the button beside it does
    <div className="in-run-value" draggable onDragStart={(event) => dragValue(event, target)}>
      <ValueView
        name={target.name}
        value={value}
        keep={`${target.path} ${target.kind} ${target.name}`}
        actions={origin ? null : eye}
      />
      {origin && (
        <div className="in-run-origin">
          <From seen={seen} watch={watch} target={target} origin={origin} />
          {eye}
        </div>
      )}
    </div>
  );
}

/** Puts the value among those that are watched, or takes it away. */
function WatchButton({ seen, target }: { seen: SeenState; target: Target }) {
  const { tab, page } = seen;
  const all = useSignal(useMemo(() => computed(() => watchedOf(tab).value), [tab]));
  const here = all.filter((each) => isSameTarget(each.target, target));
  const toggle = () => {
    for (const { id } of here) removeWatched(tab, id);
    if (here.length > 0) return;
    addWatched(tab, target);
    if (all.length > 0) return;
    const action = { title: "Show watches", command: "view.panel", argument: "watches" };
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

function From({
  seen,
  watch,
  target,
  origin,
}: Omit<LineProps, "value" | "origin"> & { origin: Origin }) {
  const { journal } = watch;
  const at_ms = journal.t_ns(journal.indexOf(origin.sequence)) / 1e6;
  const name = seen.machine.state(origin.path)?.name ?? origin.path;
  const isOwn = origin.path === seen.path;
  return (
    <>
      <span className="in-run-when">
        #{origin.sequence} at {sinceStart(at_ms, 1)}
        {isOwn ? "" : " by "}
        {!isOwn && (
          <button
            type="button"
            className="inspector-link"
            onClick={() => seen.show({ kind: "state", path: origin.path })}
          >
            {name}
          </button>
        )}
      </span>
      <IconButton
        className="inspector-mini"
        label={`Show the moment when ${target.name} came`}
        icon={<Clock size={13} />}
        onClick={() => {
          watch.moment.value = origin.seen;
        }}
      />
    </>
  );
}
