/** Bars of automatic layouts: one that is computed, and one that is shown for a machine without a drawing. */

import { LayoutGrid, Workflow } from "lucide-react";
import { useEffect } from "react";
import { proposeLayout } from "../commands/arrange.ts";
import { cancelLayout, layoutWork } from "../commands/layout_work.ts";
import type { OpenTab } from "../store/page/page.ts";
import { mayEdit } from "../store/page/rights.ts";
import { Button } from "../ui/button.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { Bar } from "./bar.tsx";
import { useSession } from "./session_context.tsx";

/** Fewest states whose layout shows a bar; smaller ones finish too soon to read it. */
const STATES_MIN = 60;

/** Progress of a long layout; Escape cancels it. */
export function LayoutWorkBar({ tab }: { tab: OpenTab }) {
  const work = useSignal(layoutWork);
  const isShown = work?.tab === tab && work.states >= STATES_MIN;
  useEffect(() => {
    if (!isShown) return;
    const cancel = (event: KeyboardEvent) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      event.stopPropagation();
      cancelLayout();
    };
    window.addEventListener("keydown", cancel, { capture: true });
    return () => window.removeEventListener("keydown", cancel, { capture: true });
  }, [isShown]);
  if (!isShown) return null;
  return (
    <Bar
      icon={<Workflow size={16} aria-hidden />}
      actions={
        <Button keys="Escape" onClick={cancelLayout}>
          Cancel
        </Button>
      }
    >
      Automatic layout of {work.states} states is in progress: {work.levelsDone} of {work.levels}{" "}
      levels are done.
    </Bar>
  );
}

/** A machine without a drawing opens arranged. The layout is saved once the user accepts it, edits or saves. */
export function ProposedLayoutBar({ tab }: { tab: OpenTab }) {
  const { page, commands, context } = useSession();
  const { session } = tab;
  const isDue = useComputed(() => session.proposal?.isDue.value ?? false, [session]);
  const isShown = useComputed(() => session.proposal?.shown.value != null, [session]);
  const may = useComputed(() => mayEdit(page), [page]);
  useEffect(() => {
    if (!isDue) return;
    void proposeLayout(tab).then((isProposed) => {
      if (isProposed && context().tab === tab) context().canvas?.fit([]);
    });
  }, [isDue, tab, context]);
  if (!isShown) return null;
  return (
    <Bar
      icon={<LayoutGrid size={16} aria-hidden />}
      actions={
        may && (
          <Button onClick={() => commands.run("arrange.keep-layout", context())}>
            Keep layout
          </Button>
        )
      }
    >
      This machine has no layout, so its states are arranged automatically.
      {may ? " Your next edit or save keeps the layout." : ""}
    </Bar>
  );
}
