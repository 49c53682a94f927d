/** A run whose runner died is resumed: what becomes of the scripts that were interrupted is chosen. */

import { useEffect, useState } from "react";
import type { Moment, OnCrash } from "../../model/generated/protocol.ts";
import type { Watch } from "../../store/history/run.ts";
import { RefusalError } from "../../store/page/server.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

const CHOICES = [
  {
    value: "abort",
    title: "End them as aborted",
    detail:
      "The crash becomes their error. The machine's own recovery handles it and the run continues.",
  },
  {
    value: "restart",
    title: "Run them again",
    detail: "The inputs are unchanged. The run continues.",
  },
  {
    value: "ask",
    title: "Decide for each state",
    detail: "Nothing is running until you decide: each interrupted state waits for your choice.",
  },
] as const satisfies readonly { value: OnCrash; title: string; detail: string }[];

export function ResumeCrashed({ asks: watch, answer }: NamedDialogProps<"resume-crashed">) {
  const names = useInterrupted(watch);
  return (
    <Dialog
      title="Resume the run"
      width={520}
      onClose={() => answer(null)}
      footer={<Button onClick={() => answer(null)}>Cancel</Button>}
    >
      <p>The program of the run died. A new one continues with the saved data. The run was in:</p>
      <ul className="resume-crashed-states">
        {names === null && <li>…</li>}
        {names?.map((name) => (
          <li key={name}>{name}</li>
        ))}
        {names?.length === 0 && <li>no state</li>}
      </ul>
      <p>What should happen to interrupted scripts?</p>
      <div className="choices">
        {CHOICES.map(({ value, title, detail }) => (
          <button key={value} type="button" className="choice" onClick={() => answer(value)}>
            <span className="choice-title">{title}</span>
            <span className="choice-detail">{detail}</span>
          </button>
        ))}
      </div>
    </Dialog>
  );
}

/** Names of the innermost states that were active at the end; null before they are known. */
function useInterrupted(watch: Watch): readonly string[] | null {
  const { page } = useSession();
  const [names, setNames] = useState<readonly string[] | null>(null);
  useEffect(() => {
    page.runs.get<Moment>(watch.id, "moments").then(
      ({ active }) => setNames(leaves(active)),
      (error: unknown) => {
        if (!(error instanceof RefusalError)) throw error;
        setNames([]);
      },
    );
  }, [page, watch]);
  return names;
}

function leaves(active: Moment["active"]): readonly string[] {
  return active
    .filter(({ path }) => !active.some((other) => other.path.startsWith(`${path}/`)))
    .map(({ names }) => names.replaceAll("/", " › "));
}
