/** A watched state: its active states, and its newest known values with those of all states inside. */

import { computed } from "@preact/signals-core";
import { X } from "lucide-react";
import { useEffect, useMemo } from "react";
import { namesTo } from "../../model/machine.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { activeStates, lanes } from "../../store/run/active.ts";
import { isIn, type ValueIn, valuesIn } from "../../store/run/values_in.ts";
import { setStateWatched } from "../../store/run/watched_states.ts";
import { IconButton } from "../../ui/button.tsx";
import { useThrottled } from "../../ui/throttled.ts";
import { useHost } from "../context.tsx";
import { dataSize } from "../parts/data_size.ts";
import { ValueView } from "../parts/value/value_view.tsx";
import { reveal } from "../reveal.ts";
import { Ahead } from "./ahead.tsx";

const PACE_MS = 200;
/** Maximum number of values. For more, watch an inner state. */
const SHOWN_MAX = 60;

interface StateCardProps {
  readonly tab: OpenTab;
  readonly path: string;
  readonly watch: Watch | null;
}

export function StateCard({ tab, path, watch }: StateCardProps) {
  const host = useHost();
  const names = namesTo(tab.session.machine, path);
  const name = names.at(-1) ?? path;
  return (
    <article className="watches-card" aria-label={`${name} and what is in it`}>
      <div className="watches-head">
        <button
          type="button"
          className="watches-link"
          title={names.join(" / ")}
          onClick={() => reveal(host, { kind: "state", path })}
        >
          {name}
        </button>
        <span className="watches-faint">and what is in it</span>
        <IconButton
          className="watches-mini"
          label={`Stop watching ${name}`}
          icon={<X size={13} />}
          onClick={() => setStateWatched(tab, path, false)}
        />
      </div>
      {watch ? (
        <InRun tab={tab} path={path} watch={watch} />
      ) : (
        <p className="watches-faint">Its values appear once a run is shown.</p>
      )}
    </article>
  );
}

function InRun({ tab, path, watch }: StateCardProps & { readonly watch: Watch }) {
  useEffect(() => watch.wantValues(), [watch]);
  const found = useMemo(
    () =>
      computed(() => ({
        active: lanes(activeStates(watch)).filter((state) => isIn(state.path, path)),
        values: valuesIn(watch, path),
      })),
    [watch, path],
  );
  const { active, values } = useThrottled(found, PACE_MS);
  const rest = values.length - SHOWN_MAX;
  return (
    <div className="watches-run shows-run">
      <p className="watches-faint">
        {active.length === 0
          ? "Nothing in it is active."
          : `Active: ${active.map(({ path: at, name }) => name || nameAt(tab, at)).join(", ")}`}
      </p>
      {values.slice(0, SHOWN_MAX).map((value) => (
        <Value
          key={`${value.kind} ${value.path} ${value.name}`}
          tab={tab}
          state={path}
          watch={watch}
          value={value}
        />
      ))}
      {rest > 0 && <p className="watches-faint">{rest} more are not shown: watch a state in it.</p>}
    </div>
  );
}

interface StateValueProps {
  readonly tab: OpenTab;
  /** Path of the watched state. */
  readonly state: string;
  readonly watch: Watch;
  readonly value: ValueIn;
}

function Value({ tab, state, watch, value }: StateValueProps) {
  const { kind, path, name, long, aheadAt_ns } = value;
  const title = path === state ? name : `${nameAt(tab, path)}.${name}`;
  const ahead = aheadAt_ns === null ? null : <Ahead watch={watch} at_ns={aheadAt_ns} />;
  return (
    <div>
      {long ? (
        <p className="watches-faint watches-long">
          {title}: a new {long.type_name || "value"} of {dataSize(long.bytes)}, which comes with its
          event.
        </p>
      ) : (
        <ValueView name={title} value={value.value} keep={`watched ${kind} ${path} ${name}`} />
      )}
      {ahead && <p className="watches-long">{ahead}</p>}
    </div>
  );
}

function nameAt(tab: OpenTab, path: string): string {
  return tab.session.machine.state(path)?.name ?? path;
}
