/** A run whose runner died is taken up again: what becomes of the scripts that were interrupted is chosen. */

import { useEffect, useState } from "react";
import type { OnCrash, Picture } from "../../model/generated/protocol.ts";
import type { Watch } from "../../store/run.ts";
import { RefusalError } from "../../store/server.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { useSession } from "../provided.tsx";
import type { AskedDialogProps } from "./dialogs.tsx";

const CHOICES = [
  {
    value: "abort",
    title: "End them by aborted",
    detail: "The crash is their error. The machine's own recovery takes over, and the run goes on.",
  },
  {
    value: "restart",
    title: "Run them again",
    detail: "With the inputs that they had. The run goes on.",
  },
  {
    value: "ask",
    title: "Decide for each state",
    detail: "Nothing moves: each interrupted state waits until you choose for it.",
  },
] as const satisfies readonly { value: OnCrash; title: string; detail: string }[];

export function TakeUp({ asks: watch, answer }: AskedDialogProps<Watch>) {
  const names = useInterrupted(watch);
  return (
    <Dialog
      title="Take the run up again"
      width={520}
      onClose={() => answer(null)}
      footer={<Button onClick={() => answer(null)}>Cancel</Button>}
    >
      <p>
        The program of the run died. Another one goes on with the data that was there. It was in:
      </p>
      <ul className="take-up-states">
        {names === null && <li>…</li>}
        {names?.map((name) => (
          <li key={name}>{name}</li>
        ))}
        {names?.length === 0 && <li>no state</li>}
      </ul>
      <p>What becomes of scripts that were interrupted?</p>
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
    page.runs.get<Picture>(watch.id, "moments").then(
      ({ active }) => setNames(leaves(active)),
      (error: unknown) => {
        if (!(error instanceof RefusalError)) throw error;
        setNames([]);
      },
    );
  }, [page, watch]);
  return names;
}

function leaves(active: Picture["active"]): readonly string[] {
  return active
    .filter(({ path }) => !active.some((other) => other.path.startsWith(`${path}/`)))
    .map(({ names }) => names.replaceAll("/", " › "));
}
