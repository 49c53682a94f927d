/** Frequent commands of runs: start, pause, stop, step; the state of the current run, and the other runs. */

import {
  ArrowDownToLine,
  ArrowRightToLine,
  ArrowUpFromLine,
  ChevronDown,
  Footprints,
  Pause,
  Play,
  Square,
  Undo2,
} from "lucide-react";
import { type ReactNode, useRef, useState } from "react";
import { useRefusalOf } from "../panels/context.tsx";
import type { FreeCommandId } from "../store/page/command_arguments.ts";
import { liveRun, runningBeside, snapshotOf } from "../store/run/running.ts";
import { Button, IconButton } from "../ui/button.tsx";
import { ContextMenu } from "../ui/menu.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useEntries } from "./entries.ts";
import { useShownKey } from "./keys_shown.ts";
import { RunChooser } from "./run_chooser.tsx";
import { useSession } from "./session_context.tsx";
import "./run_controls.css";

export function RunControls() {
  const { page } = useSession();
  const tab = useSignal(page.active);
  const isLive = useComputed(() => liveRun(page.active.value) !== null, [page]);
  const isPaused = useComputed(() => {
    const status = snapshotOf(liveRun(page.active.value))?.status;
    return status === "paused" || status === "stepping";
  }, [page]);
  if (!tab) return null;
  return (
    <div className="run-controls" role="toolbar" aria-label="Run">
      <RunChooser tab={tab} />
      <Start />
      {isLive && (
        <>
          {isPaused ? (
            <RunButton id="run.resume" keysOf="run.toggle-pause" icon={<Play size={14} />}>
              Resume
            </RunButton>
          ) : (
            <RunButton id="run.pause" keysOf="run.toggle-pause" icon={<Pause size={14} />}>
              Pause
            </RunButton>
          )}
          <RunButton id="run.stop" icon={<Square size={13} />} className="run-stop">
            Stop
          </RunButton>
          {isPaused ? (
            <Steps />
          ) : (
            <RunButton id="run.step-mode" icon={<Footprints size={14} />}>
              Step mode
            </RunButton>
          )}
        </>
      )}
    </div>
  );
}

function Steps() {
  return (
    <div className="run-steps">
      <RunButton id="run.into" icon={<ArrowDownToLine size={14} />}>
        Into
      </RunButton>
      <RunButton id="run.over" icon={<ArrowRightToLine size={14} />}>
        Over
      </RunButton>
      <RunButton id="run.out" icon={<ArrowUpFromLine size={14} />}>
        Out
      </RunButton>
      <RunButton id="run.back" icon={<Undo2 size={14} />}>
        Back
      </RunButton>
    </div>
  );
}

interface RunButtonProps {
  readonly id: FreeCommandId;
  /** The command whose shortcut applies, if it is another. */
  readonly keysOf?: string;
  readonly icon: ReactNode;
  readonly className?: string;
  readonly children: ReactNode;
}

/** A button for a command, with why it cannot be done where it cannot. */
function RunButton({ id, keysOf, icon, className, children }: RunButtonProps) {
  const { commands, context } = useSession();
  const shown = useShownKey();
  const refusal = useRefusalOf(id);
  const command = commands.get(id);
  return (
    <Button
      kind="quiet"
      className={className}
      icon={icon}
      disabled={refusal !== null}
      title={refusal || `${command?.title}: ${command?.detail ?? ""}`}
      keys={shown(keysOf ?? id)}
      onClick={() => commands.run(id, context())}
    >
      {children}
    </Button>
  );
}

/** Start, and a menu with the other ways to begin. */
function Start() {
  const { page } = useSession();
  const place = useRef<HTMLDivElement>(null);
  const [at, setAt] = useState<{ x: number; y: number } | null>(null);
  const refusal = useRefusalOf("run.start");
  const isOn = useComputed(() => {
    const tab = page.active.value;
    return tab !== null && runningBeside(page, tab).length > 0;
  }, [page]);
  const items = useEntries(["run.start", "run.start-with", "run.start-held", "run.start-here"]);
  const open = () => {
    const box = place.current?.getBoundingClientRect();
    if (box) setAt({ x: box.left, y: box.bottom + 2 });
  };
  return (
    <div ref={place} className={isOn ? "run-start run-start-beside" : "run-start"}>
      <RunButton id="run.start" icon={<Play size={14} />}>
        Start
      </RunButton>
      <IconButton
        label="Other ways to start"
        icon={<ChevronDown size={14} />}
        disabled={refusal !== null}
        onClick={open}
      />
      {at && (
        <ContextMenu label="ways to start" at={at} items={items()} onClose={() => setAt(null)} />
      )}
    </div>
  );
}
