/** What wants a human at once, in every layout: open questions and crashed runs, one press from where they are answered. */

import { CircleHelp, TriangleAlert } from "lucide-react";
import type { Page } from "../store/page.ts";
import { openQuestions } from "../store/questions.ts";
import type { Watch } from "../store/run.ts";
import { useDerived, useSession } from "./provided.tsx";
import "./wanting.css";

export function Wanting() {
  const { page, commands, context } = useSession();
  const asking = useDerived(
    () => firstOf(page, (watch) => openQuestions(watch).length > 0),
    [page],
  );
  const count = useDerived(
    () => watches(page).reduce((sum, watch) => sum + openQuestions(watch).length, 0),
    [page],
  );
  const crashed = useDerived(
    () => firstOf(page, (watch) => watch.now.value?.run.phase === "crashed"),
    [page],
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

function watches(page: Page): readonly Watch[] {
  return [...new Set(page.tabs.value.flatMap((tab) => tab.run.value ?? []))];
}

function firstOf(page: Page, fits: (watch: Watch) => boolean): Watch | null {
  return watches(page).find(fits) ?? null;
}
