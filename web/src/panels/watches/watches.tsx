/** Values that the user watches: now or at the shown moment, and over the time of the run. */

import { computed } from "@preact/signals-core";
import { type DragEvent, useMemo, useState } from "react";
import { type PortKind, portsOf } from "../../model/machine.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { selectedStates } from "../../store/page/view.ts";
import { setStateWatched, watchedStatesOf } from "../../store/run/watched_states.ts";
import { addWatched, type Target, watchedOf } from "../../store/run/watched_values.ts";
import { Empty } from "../../ui/empty.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { duration } from "../parts/duration.ts";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { droppedValue, isValueDrag } from "../parts/value/dragged_value.ts";
import { StateCard } from "./state_card.tsx";
import { WatchCard } from "./watch_card.tsx";
import "./watches.css";

export const Watches = forTab(WatchesOfTab, "Values that you watch appear here.");

function WatchesOfTab({ tab }: TabPanelProps) {
  const all = useSignal(useMemo(() => computed(() => watchedOf(tab).value), [tab]));
  const states = useSignal(useMemo(() => computed(() => watchedStatesOf(tab).value), [tab]));
  const watch = useSignal(tab.run);
  const [isOver, setOver] = useState(false);
  const drop = (event: DragEvent<HTMLElement>) => {
    setOver(false);
    const target = droppedValue(event);
    if (!target) return;
    event.preventDefault();
    addWatched(tab, target);
  };
  return (
    <section
      className="watches"
      aria-label="Watched values"
      data-over={isOver}
      onDragOver={(event) => {
        if (!isValueDrag(event)) return;
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={drop}
    >
      <Adding tab={tab} />
      {watch && <AskedOfRobot watch={watch} />}
      {all.length + states.length === 0 && (
        <Empty
          title="Nothing is watched"
          text="Press the eye beside a value in the inspector, drag a value here, or choose a value of the selected state above."
        />
      )}
      {states.map((path) => (
        <StateCard key={`${path} ${watch?.id ?? ""}`} tab={tab} path={path} watch={watch} />
      ))}
      {all.map((watched) => (
        <WatchCard
          key={`${watched.id} ${watch?.id ?? ""}`}
          tab={tab}
          watched={watched}
          watch={watch}
        />
      ))}
    </section>
  );
}

/** Time for a response in addition to the delay of the link, in ms. A longer silence is reported. */
const ANSWER_MS = 6_000;

/** Warns that the robot has not confirmed the watched values, or does not send all of them ahead. */
function AskedOfRobot({ watch }: { watch: Watch }) {
  const { page } = useHost().context();
  const { watching } = useSignal(watch.ahead);
  const robot = useComputed(() => watch.now.value?.robot ?? null, [watch]);
  const pulse = useSignal(page.server.pulse);
  if (!watching || !robot) return null;
  // Time of the server, so that a silent server does not appear as a silent robot.
  const waits_ms = (pulse?.server_ms ?? 0) - watching.asked_ms;
  const patience_ms = 2 * (robot.round_trip_ms ?? 0) + ANSWER_MS;
  const isOpen = !watching.is_confirmed && waits_ms > patience_ms;
  if (!isOpen && watching.left_out === 0) return null;
  return (
    <p className="watches-asked" role="status">
      {isOpen &&
        `${robot.robot} has not answered for ${duration(waits_ms)} which values are watched here: until it does, values come with their events, or as they were watched before. `}
      {watching.left_out > 0 &&
        `${watching.left_out} of the watched values are too many for the link: they come with their events only.`}
    </p>
  );
}

const KINDS: readonly PortKind[] = ["input", "output", "scoped_variable"];
const KIND_TITLES = { input: "Input", output: "Output", scoped_variable: "Scoped variable" };

/** Value of the option that watches the selected state with everything inside. Other options are single values. */
const WHOLE_STATE = "state";

/** Adds the selected state or one of its values, even before they have a value. */
function Adding({ tab }: { tab: OpenTab }) {
  const selection = useSignal(tab.view.selection);
  const version = useSignal(tab.session.version);
  const { machine } = tab.session;
  // biome-ignore lint/correctness/useExhaustiveDependencies: the machine is a mutable object; its version changes with it
  const [state, targets] = useMemo(() => {
    const [path = machine.root] = selectedStates(tab.view);
    const found = machine.state(path);
    if (!found) return [null, []] as const;
    const values = KINDS.flatMap((kind) =>
      portsOf(found, kind).map(({ name }): Target => ({ kind, path, name })),
    );
    return [{ path, name: found.name }, values] as const;
  }, [tab, machine, selection, version]);
  const choose = (value: string) => {
    if (value === WHOLE_STATE && state) return setStateWatched(tab, state.path, true);
    const target = targets[Number(value)];
    if (target) addWatched(tab, target);
  };
  return (
    <label className="watches-add">
      <span className="visually-hidden">Watch a value</span>
      <select
        className="field-input"
        value=""
        disabled={!state}
        onChange={(event) => choose(event.currentTarget.value)}
      >
        <option value="">
          {state ? `Watch ${state.name} or a value of it…` : "Select a state to watch it"}
        </option>
        {state && <option value={WHOLE_STATE}>{state.name} and what is in it</option>}
        {targets.map((target, index) => (
          <option key={`${target.kind} ${target.name}`} value={index}>
            {KIND_TITLES[target.kind as PortKind]} {target.name}
          </option>
        ))}
      </select>
    </label>
  );
}
