/** Urgent items in every layout: open questions and crashed runs, one press from their answers. */

import { CircleHelp, TriangleAlert } from "lucide-react";
import { openQuestions } from "../store/history/questions.ts";
import type { Watch } from "../store/history/run.ts";
import { useComputed } from "../ui/signals.ts";
import { type AppSession, isInMission } from "./session.ts";
import { useSession } from "./session_context.tsx";
import "./attention_buttons.css";

export function AttentionButtons() {
  const session = useSession();
  const { commands, context } = session;
  const asking = useComputed(
    () => firstOf(session, (watch) => openQuestions(watch).length > 0),
    [session],
  );
  const count = useComputed(
    () => watches(session).reduce((sum, watch) => sum + openQuestions(watch).length, 0),
    [session],
  );
  const crashed = useComputed(
    () => firstOf(session, (watch) => watch.now.value?.run.phase === "crashed"),
    [session],
  );
  const show = (watch: Watch) => commands.run("mission.show", context(), watch.id);
  return (
    <>
      {crashed && (
        <button type="button" className="wanting wanting-crash" onClick={() => show(crashed)}>
          <TriangleAlert size={15} aria-hidden />
          crashed
        </button>
      )}
      {asking && (
        <button type="button" className="wanting" onClick={() => show(asking)}>
          <CircleHelp size={15} aria-hidden />
          {count === 1 ? "1 question" : `${count} questions`}
        </button>
      )}
    </>
  );
}

/** The shown runs, except the one in mission control. */
function watches(session: AppSession): readonly Watch[] {
  const tabs = session.page.tabs.value.filter((tab) => !isInMission(session, tab));
  return [...new Set(tabs.flatMap((tab) => tab.run.value ?? []))];
}

function firstOf(session: AppSession, fits: (watch: Watch) => boolean): Watch | null {
  return watches(session).find(fits) ?? null;
}
