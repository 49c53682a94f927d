/** Decisions after a crash of the run: how to resume, with the consequences of each choice, and scripts that wait for a decision.
 * It also reports a replica that differs from the run on the robot. */

import { GitCompareArrows, RotateCcw, TriangleAlert, Undo2 } from "lucide-react";
import type { ReactNode } from "react";
import type { OnCrash } from "../../model/generated/protocol.ts";
import { joinFew } from "../../model/join_few.ts";
import type { Watch } from "../../store/history/run.ts";
import { activeStates, lanes } from "../../store/run/active.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useCommand, useRefusalOf } from "../context.tsx";
import { pathInWords, useMachineNames } from "./names.ts";

export function Crash({ watch }: { readonly watch: Watch }) {
  const run = useComputed(() => watch.now.value?.run, [watch]);
  if (run?.phase === "diverged") return <Diverged reason={run.reason} />;
  return run?.phase === "crashed" ? <ResumeCrashed watch={watch} /> : <Interrupted watch={watch} />;
}

function Diverged({ reason }: { readonly reason: string }) {
  return (
    <section
      className="mission-part mission-crash"
      role="alert"
      aria-label="The replica has diverged"
    >
      <h3>
        <GitCompareArrows size={20} aria-hidden />
        This is not the run that the robot has
      </h3>
      <p>{reason.charAt(0).toUpperCase() + reason.slice(1)}.</p>
    </section>
  );
}

const CHOICES: readonly {
  readonly policy: OnCrash;
  readonly title: string;
  readonly means: string;
}[] = [
  {
    policy: "ask",
    title: "Resume and ask",
    means: "nothing runs by itself: interrupted scripts wait for your decision",
  },
  {
    policy: "restart",
    title: "Run scripts again",
    means: "interrupted scripts restart with unchanged inputs",
  },
  {
    policy: "abort",
    title: "Abort scripts",
    means: "interrupted states end as aborted, and the machine handles that",
  },
];

function ResumeCrashed({ watch }: { readonly watch: Watch }) {
  const run = useCommand();
  const names = useMachineNames();
  const active = useComputed(() => lanes(activeStates(watch)), [watch]);
  const where = joinFew(active.map(({ path }) => pathInWords(names, path)));
  const refusal = useRefusalOf("run.resume-crashed");
  return (
    <section className="mission-part mission-crash" aria-label="The run crashed">
      <h3>
        <TriangleAlert size={20} aria-hidden />
        The program of the run died
      </h3>
      <p>
        {where !== "" && `It was at ${where}. `}Nothing moves until the run is resumed. Everything
        that happened is kept, and the run can continue from there:
      </p>
      <ul className="mission-choices mission-resume-crashed">
        {CHOICES.map(({ policy, title, means }) => (
          <li key={policy}>
            <Button
              kind={policy === "ask" ? "primary" : "plain"}
              disabled={refusal !== null}
              onClick={() => run("run.resume-crashed", policy)}
            >
              {title}
            </Button>
            <span className="mission-soft">{means}</span>
          </li>
        ))}
      </ul>
      {refusal && <p className="mission-why">You cannot resume it: {refusal}.</p>}
    </section>
  );
}

function Interrupted({ watch }: { readonly watch: Watch }) {
  const run = useCommand();
  const names = useMachineNames();
  const refusal = useRefusalOf("run.recover");
  const all = useComputed(() => activeStates(watch), [watch]);
  const waiting = all.filter(({ phase }) => phase === "interrupted");
  if (waiting.length === 0) return null;
  const decide = (path: string, policy: "restart" | "abort", title: string, sign: ReactNode) => (
    <Button
      icon={sign}
      disabled={refusal !== null}
      onClick={() => run("run.recover", { path, policy })}
    >
      {title}
    </Button>
  );
  return (
    <section className="mission-part mission-crash" aria-label="Interrupted scripts">
      <h3>
        <TriangleAlert size={20} aria-hidden />A crash interrupted running scripts
      </h3>
      <ul className="mission-choices mission-decide">
        {waiting.map(({ path }) => (
          <li key={path}>
            <strong>{pathInWords(names, path)}</strong>
            {decide(path, "restart", "Run again", <RotateCcw size={16} aria-hidden />)}
            {decide(path, "abort", "End as aborted", <Undo2 size={16} aria-hidden />)}
          </li>
        ))}
      </ul>
      {refusal && <p className="mission-why">You cannot decide: {refusal}.</p>}
    </section>
  );
}
