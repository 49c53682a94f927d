/** The page shows an earlier moment of a run: which one, how long ago, and the ways on from it. */

import { ChevronFirst, ChevronLast, ChevronLeft, ChevronRight, History, Radio } from "lucide-react";
import { type ReactNode, useEffect } from "react";
import { duration } from "../panels/parts/duration.ts";
import { useMoment } from "../panels/parts/moment_words.ts";
import { timelineOf } from "../panels/timeline/model.ts";
import type { Watch } from "../store/history/run.ts";
import type { FreeCommandId } from "../store/page/command_arguments.ts";
import type { OpenTab } from "../store/page/page.ts";
import { gapsOf } from "../store/run/gaps.ts";
import { Button, IconButton } from "../ui/button.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useKeys } from "./keys_shown.ts";
import { useSession } from "./session_context.tsx";
import "./moment_bar.css";

export function MomentBar({ tab }: { tab: OpenTab }) {
  const watch = useSignal(tab.run);
  return watch && <OfRun tab={tab} watch={watch} />;
}

interface MomentBarProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
}

function OfRun({ tab, watch }: MomentBarProps) {
  const { page } = useSession();
  // From now on the gaps in the received data are recorded, whether or not the time line is visible.
  useEffect(() => void gapsOf(watch, page), [page, watch]);
  const playhead = useSignal(watch.playhead);
  return playhead === null ? null : <OfMoment tab={tab} watch={watch} playhead={playhead} />;
}

function OfMoment({ tab, watch, playhead }: MomentBarProps & { readonly playhead: number }) {
  const { commands, context } = useSession();
  const { index, when, what } = useMoment(tab, watch);
  const snapshot = useSignal(watch.playheadSnapshot);
  const isHere = snapshot?.picture.sequence === playhead;
  const isOver = useSignal(watch.now)?.link === "over";
  return (
    <section className="moment-bar" aria-label="Shown moment">
      <History size={16} aria-hidden />
      <span className="moment-text" role="status">
        <strong className="moment-when">{when}</strong>
        <span className="moment-what">{what}</span>
        <span className="moment-soft">
          event {playhead.toLocaleString("en")} of{" "}
          {watch.journal.sequence(watch.journal.length - 1).toLocaleString("en")}
          {when !== "" && <Ago watch={watch} index={index} />}
          {!isHere && ", loading its values"}
        </span>
      </span>
      <span className="moment-steps">
        <Step id="run.entry-before" icon={<ChevronFirst size={16} />} tab={tab} watch={watch} />
        <Step id="run.event-before" icon={<ChevronLeft size={16} />} tab={tab} watch={watch} />
        <Step id="run.event-after" icon={<ChevronRight size={16} />} tab={tab} watch={watch} />
        <Step id="run.entry-after" icon={<ChevronLast size={16} />} tab={tab} watch={watch} />
      </span>
      <StartFromHere tab={tab} watch={watch} />
      <Button
        kind="primary"
        icon={<Radio size={14} />}
        onClick={() => commands.run("run.live", context())}
      >
        {isOver ? "Go to the end" : "Back to live"}
      </Button>
    </section>
  );
}

/** Time before now or before the end. */
function Ago({ watch, index }: { readonly watch: Watch; readonly index: number }) {
  const { page } = useSession();
  const now = useSignal(watch.now);
  const t_ms = watch.window.t_ns(index) / 1e6;
  const come_ms = useComputed(() => timelineOf(watch, page).end_ns / 1e6, [page, watch]);
  const before = duration(Math.max(0, come_ms - t_ms));
  return `, ${before} ${now?.link === "over" ? "before the end" : "ago"}`;
}

function useRefusal(id: FreeCommandId, { tab, watch }: MomentBarProps): string | null {
  const { commands, context } = useSession();
  return useComputed(() => {
    watch.journalVersion.value;
    watch.playhead.value;
    watch.now.value;
    tab.view.selection.value;
    return commands.refusalOf(id, context());
  }, [tab, watch, commands, context, id]);
}

function Step({
  id,
  icon,
  ...of
}: MomentBarProps & { readonly id: FreeCommandId; readonly icon: ReactNode }) {
  const { commands, context } = useSession();
  const keys = useKeys()(id)[0];
  const refusal = useRefusal(id, of);
  const title = commands.get(id)?.title ?? id;
  return (
    <IconButton
      label={title}
      keys={refusal ?? keys}
      icon={icon}
      disabled={refusal !== null}
      onClick={() => commands.run(id, context())}
    />
  );
}

function StartFromHere(of: MomentBarProps) {
  const { commands, context } = useSession();
  const refusal = useRefusal("run.start-from-history", of);
  return (
    <Button
      disabled={refusal !== null}
      title={refusal ?? "Restarts the run here with the data it had then, and pauses it"}
      onClick={() => commands.run("run.start-from-history", context())}
    >
      Start from here
    </Button>
  );
}
