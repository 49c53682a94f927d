/** Bars above the canvas with urgent information about the machine, each with its remedies. */

import { ChevronDown, ChevronUp, Eye, FileWarning, LifeBuoy, Unplug } from "lucide-react";
import { useEffect, useState } from "react";
import { agePhrase } from "../panels/parts/age.ts";
import type { FreeCommandId } from "../store/page/command_arguments.ts";
import type { OpenTab } from "../store/page/page.ts";
import { mayEdit } from "../store/page/rights.ts";
import { Button, IconButton } from "../ui/button.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { Bar } from "./bar.tsx";
import { LayoutWorkBar, ProposedLayoutBar } from "./layout_bars.tsx";
import { MomentBar } from "./moment_bar.tsx";
import { RunBars } from "./run_bars.tsx";
import { RunFateBars } from "./run_fate_bars.tsx";
import { isInMission } from "./session.ts";
import { useSession } from "./session_context.tsx";

/** On a low page only the most severe one is shown, with a button for the others. */
export function Bars({ tab }: { tab: OpenTab }) {
  const [isOpen, setOpen] = useState(false);
  return (
    <div className={isOpen ? "bars" : "bars bars-folded"}>
      <LinkBar tab={tab} />
      <RunBars tab={tab} />
      <MomentBar tab={tab} />
      <RunFateBars tab={tab} />
      <ReadOnlyBar tab={tab} />
      <DiskBar tab={tab} />
      <RecoveredBar tab={tab} />
      <LayoutWorkBar tab={tab} />
      <ProposedLayoutBar tab={tab} />
      <SetAsideBar tab={tab} />
      <div className="bars-more">
        <IconButton
          label={isOpen ? "Show only one bar" : "Show the other bars"}
          icon={isOpen ? <ChevronUp size={15} /> : <ChevronDown size={15} />}
          onClick={() => setOpen(!isOpen)}
        />
      </div>
    </div>
  );
}

/** The connection is lost; this is the age of the shown data. */
function LinkBar({ tab }: { tab: OpenTab }) {
  const { page } = useSession();
  const link = useSignal(page.server.link);
  const pending = useSignal(tab.session.pending);
  const now_ms = useNow(link.state === "down");
  if (link.state !== "down") return null;
  const waiting =
    pending.length === 0
      ? ""
      : ` ${pending.length === 1 ? "One edit waits" : `${pending.length} edits wait`} to be sent.`;
  return (
    <Bar
      kind="danger"
      icon={<Unplug size={16} aria-hidden />}
      actions={<Button onClick={() => page.server.retry()}>Try again now</Button>}
    >
      No connection for {agePhrase(now_ms - link.since_ms)}: {link.reason}. What you see may be out
      of date.{waiting}
    </Bar>
  );
}

/** The time, updated every second while it is needed. */
export function useNow(wanted: boolean): number {
  const [now_ms, setNow] = useState(() => Date.now());
  useEffect(() => {
    if (!wanted) return;
    setNow(Date.now());
    const timer = setInterval(() => setNow(Date.now()), 1_000);
    return () => clearInterval(timer);
  }, [wanted]);
  return now_ms;
}

/** In mission control it is shown beside the user's rights. */
function ReadOnlyBar({ tab }: { tab: OpenTab }) {
  const session = useSession();
  const isWanted = useComputed(
    () => !mayEdit(session.page) && !isInMission(session, tab),
    [session, tab],
  );
  if (!isWanted) return null;
  return (
    <Bar icon={<Eye size={16} aria-hidden />}>
      You can view this machine but not edit it. Ask an admin for the role engineer.
    </Bar>
  );
}

function DiskBar({ tab }: { tab: OpenTab }) {
  const { page, commands, context } = useSession();
  const status = useSignal(tab.session.status);
  const may = useComputed(() => mayEdit(page), [page]);
  const disk = status?.summary.disk ?? "same";
  if (disk === "same") return null;
  const run = (id: FreeCommandId) => commands.run(id, context());
  const text =
    disk === "missing"
      ? "The files of this machine were deleted from disk. Save to restore them."
      : "Another program changed the files of this machine on disk.";
  return (
    <Bar
      kind="warning"
      icon={<FileWarning size={16} aria-hidden />}
      actions={
        may && (
          <>
            {disk === "changed" && (
              <>
                <Button onClick={() => run("file.compare")}>Compare</Button>
                <Button onClick={() => run("file.reload")}>Take theirs</Button>
              </>
            )}
            <Button onClick={() => run("file.overwrite")}>
              {disk === "changed" ? "Keep mine" : "Save"}
            </Button>
          </>
        )
      }
    >
      {text}
    </Bar>
  );
}

function RecoveredBar({ tab }: { tab: OpenTab }) {
  const { commands, context } = useSession();
  const status = useSignal(tab.session.status);
  const [closed, setClosed] = useState(false);
  if (closed || !status?.summary.is_recovered || !status.summary.is_changed) return null;
  return (
    <Bar
      icon={<LifeBuoy size={16} aria-hidden />}
      actions={
        <>
          <Button onClick={() => commands.run("file.compare", context())}>Compare</Button>
          <Button onClick={() => commands.run("file.save", context())}>Save</Button>
          <Button onClick={() => setClosed(true)}>Hide</Button>
        </>
      }
    >
      Unsaved edits from before the server ended are restored. Undo removes them one by one.
    </Bar>
  );
}

function SetAsideBar({ tab }: { tab: OpenTab }) {
  const { commands, context } = useSession();
  const status = useSignal(tab.session.status);
  if ((status?.summary.set_aside ?? 0) === 0) return null;
  return (
    <Bar
      kind="warning"
      icon={<LifeBuoy size={16} aria-hidden />}
      actions={
        <Button onClick={() => commands.run("file.set-aside", context())}>Show edits</Button>
      }
    >
      Unsaved edits from before the server ended could not be restored. They are set aside.
    </Bar>
  );
}
