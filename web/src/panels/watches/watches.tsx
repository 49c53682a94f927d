/** Values that the user watches: what they are now or at the moment that is shown, and over the time of the run. */

import { computed } from "@preact/signals-core";
import { type DragEvent, useMemo, useState } from "react";
import { type PortKind, portsOf } from "../../model/machine.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { selectedStates } from "../../store/page/view.ts";
import { addWatched, type Target, watchedOf } from "../../store/run/watched_values.ts";
import { Empty } from "../../ui/empty.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab } from "../context.tsx";
import { droppedValue, isValueDrag } from "../parts/value/dragged_value.ts";
import { WatchCard } from "./watch_card.tsx";
import "./watches.css";

export function Watches() {
  const tab = useActiveTab();
  return tab ? (
    <OfTab key={tab.session.id} tab={tab} />
  ) : (
    <Empty title="No machine is open" text="Values that you watch appear here." />
  );
}

function OfTab({ tab }: { tab: OpenTab }) {
  const all = useSignal(useMemo(() => computed(() => watchedOf(tab).value), [tab]));
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
      {all.length === 0 && (
        <Empty
          title="Nothing is watched"
          text="Press the eye beside a value in the inspector, drag a value here, or choose a value of the selected state above."
        />
      )}
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

const KINDS: readonly PortKind[] = ["input", "output", "scoped_variable"];
const KIND_TITLES = { input: "Input", output: "Output", scoped_variable: "Scoped variable" };

/** Values of the selected state can be watched before they are there. */
function Adding({ tab }: { tab: OpenTab }) {
  const selection = useSignal(tab.view.selection);
  const version = useSignal(tab.session.version);
  const { machine } = tab.session;
  // biome-ignore lint/correctness/useExhaustiveDependencies: the machine stays the same object; its version tells of changes
  const targets = useMemo(() => {
    const [path = machine.root] = selectedStates(tab.view);
    const state = machine.state(path);
    if (!state) return [];
    return KINDS.flatMap((kind) =>
      portsOf(state, kind).map(({ name }): Target => ({ kind, path, name })),
    );
  }, [tab, machine, selection, version]);
  const [first] = targets;
  const name = first ? (machine.state(first.path)?.name ?? "") : "";
  return (
    <label className="watches-add">
      <span className="visually-hidden">Watch a value</span>
      <select
        className="field-input"
        value=""
        disabled={targets.length === 0}
        onChange={(event) => {
          const target = targets[Number(event.currentTarget.value)];
          if (target) addWatched(tab, target);
        }}
      >
        <option value="">
          {first ? `Watch a value of ${name}…` : "Select a state with ports to watch their values"}
        </option>
        {targets.map((target, index) => (
          <option key={`${target.kind} ${target.name}`} value={index}>
            {KIND_TITLES[target.kind as PortKind]} {target.name}
          </option>
        ))}
      </select>
    </label>
  );
}
