/** Breakpoints of the active machine: those of its current run, or else those for the next start. */

import { CirclePause, CirclePlus, Pencil, Trash2 } from "lucide-react";
import {
  cannotSetBreakpoints,
  cannotSetConditions,
  removeBreakpoint,
  setBreakpoint,
} from "../../commands/run_points.ts";
import type { Breakpoint } from "../../model/generated/protocol.ts";
import { namesTo } from "../../model/machine.ts";
import { hitsOf } from "../../store/history/hits.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { select, selectedStates } from "../../store/page/view.ts";
import { activeStates, isHolding } from "../../store/run/active.ts";
import { breakpointsOf } from "../../store/run/breakpoints.ts";
import { liveRun } from "../../store/run/running.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useCommand, useHost } from "../context.tsx";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { AtMoment } from "./at_moment.tsx";
import { breakpointInWords } from "./words.ts";
import "./breakpoints.css";

export const Breakpoints = forTab(BreakpointsOfTab, "Breakpoints of the open machine appear here.");

function BreakpointsOfTab({ tab }: TabPanelProps) {
  const host = useHost();
  const all = useComputed(() => breakpointsOf(tab), [tab]);
  const live = useComputed(() => liveRun(tab), [tab]);
  const refusal = useComputed(() => cannotSetBreakpoints(host.context()), [host]);
  const shown = useSignal(tab.run);
  useSignal(tab.session.version);
  return (
    <div className="breakpoints">
      <Bar tab={tab} all={all} refusal={refusal} />
      {all.length === 0 ? (
        <Empty
          title="No breakpoints"
          text="Click the upper left corner of a state on the canvas, or select a state and press Ctrl+F9. The run pauses before it."
        />
      ) : (
        <>
          <p className="breakpoints-whose">
            {live ? "In the active run" : "For the next start, kept in this browser"}
          </p>
          <ul className="breakpoints-list">
            {all.map((breakpoint) => (
              <Row key={breakpoint.id} tab={tab} breakpoint={breakpoint} refusal={refusal} />
            ))}
          </ul>
        </>
      )}
      {shown && <AtMoment tab={tab} watch={shown} />}
    </div>
  );
}

interface BreakpointBarProps {
  readonly tab: OpenTab;
  readonly all: readonly Breakpoint[];
  readonly refusal: string | null;
}

function Bar({ tab, all, refusal }: BreakpointBarProps) {
  const host = useHost();
  const run = useCommand();
  const selected = useComputed(() => selectedStates(tab.view).length === 1, [tab]);
  const isOn = all.some(({ enabled }) => enabled);
  const switchAll = async () => {
    for (const breakpoint of all) {
      if (breakpoint.enabled === isOn) {
        await setBreakpoint(host.context(), { ...breakpoint, enabled: !isOn });
      }
    }
  };
  return (
    <div className="breakpoints-bar">
      <Button
        icon={<CirclePlus size={14} />}
        disabled={!selected || refusal !== null}
        title={
          refusal ?? (selected ? "Before or after the selected state" : "Select a state first")
        }
        onClick={() => run("run.edit-breakpoint")}
      >
        Add…
      </Button>
      <Button
        disabled={all.length === 0 || refusal !== null}
        title={refusal ?? undefined}
        onClick={() => void switchAll()}
      >
        {isOn || all.length === 0 ? "All off" : "All on"}
      </Button>
      <IconButton
        label="Remove all breakpoints"
        icon={<Trash2 size={14} />}
        disabled={all.length === 0 || refusal !== null}
        onClick={() => run("run.clear-breakpoints")}
      />
    </div>
  );
}

interface BreakpointRowProps {
  readonly tab: OpenTab;
  readonly breakpoint: Breakpoint;
  readonly refusal: string | null;
}

function Row({ tab, breakpoint, refusal }: BreakpointRowProps) {
  const host = useHost();
  const run = useCommand();
  const { machine } = tab.session;
  const { id, path, enabled, condition } = breakpoint;
  const watch = useSignal(tab.run);
  const hits = useComputed(() => (watch ? (hitsOf(watch).get(id) ?? 0) : null), [watch, id]);
  const holds = useComputed(
    () => watch !== null && isHolding(activeStates(watch), id),
    [watch, id],
  );
  const names = namesTo(machine, path);
  const name = names.at(-1) ?? path;
  const isGone = machine.state(path) === undefined;
  const unfit = condition === null ? null : cannotSetConditions(host.context());
  const why = refusal ?? unfit;
  const show = () => {
    select(tab.view, [{ kind: "state", path }]);
    host.context().canvas?.reveal({ kind: "state", path });
  };
  return (
    <li className={`breakpoint ${enabled ? "" : "breakpoint-off"}`}>
      <div className="breakpoint-head">
        <input
          type="checkbox"
          aria-label={`Breakpoint ${id} is on`}
          title={why ?? undefined}
          disabled={why !== null}
          checked={enabled}
          onChange={() => void setBreakpoint(host.context(), { ...breakpoint, enabled: !enabled })}
        />
        <button type="button" className="breakpoint-name" title={names.join(" › ")} onClick={show}>
          <span className="breakpoint-number">{id}</span> {name}
        </button>
        <IconButton
          label={`Edit breakpoint ${id}`}
          icon={<Pencil size={13} />}
          disabled={why !== null}
          onClick={() => run("run.edit-breakpoint", breakpoint)}
        />
        <IconButton
          label={`Remove breakpoint ${id}`}
          icon={<Trash2 size={13} />}
          disabled={refusal !== null}
          onClick={() => void removeBreakpoint(host.context(), id)}
        />
      </div>
      {condition !== null && <code className="breakpoint-condition">{condition}</code>}
      <div className="breakpoint-words">
        {holds && (
          <span className="breakpoint-holds">
            <CirclePause size={13} aria-hidden /> pausing
          </span>
        )}
        {isGone ? "its state no longer exists" : breakpointInWords(breakpoint)}
        {hits !== null && hits > 0 && (
          <span className="breakpoint-hits">{hits === 1 ? "1 hit" : `${hits} hits`}</span>
        )}
      </div>
    </li>
  );
}
