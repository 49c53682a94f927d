/** Bars above the canvas on the fate of a run: it crashed, scripts wait for a decision, or it runs another machine. Each has its
 * remedies. */

import { GitCompareArrows, Skull, TriangleAlert } from "lucide-react";
import { useEffect, useState } from "react";
import type { OnCrash } from "../model/generated/protocol.ts";
import { joinFew } from "../model/join_few.ts";
import { namesTo } from "../model/machine.ts";
import { useRefusalOf } from "../panels/context.tsx";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab } from "../store/page/page.ts";
import { activeStates } from "../store/run/active.ts";
import { differsFromRun } from "../store/run/run_difference.ts";
import { liveRun, snapshotOf } from "../store/run/running.ts";
import { Button } from "../ui/button.tsx";
import { isSameList, useComputed, useSignal } from "../ui/signals.ts";
import { Bar } from "./bar.tsx";
import { isInMission } from "./session.ts";
import { useSession } from "./session_context.tsx";

export function RunFateBars({ tab }: { tab: OpenTab }) {
  const session = useSession();
  const watch = useSignal(tab.run);
  const isInMissionControl = useComputed(() => isInMission(session, tab), [session, tab]);
  if (!watch) return null;
  return (
    <>
      {!isInMissionControl && <DivergedBar watch={watch} />}
      {!isInMissionControl && <CrashBar tab={tab} watch={watch} />}
      {!isInMissionControl && <InterruptedBar tab={tab} watch={watch} />}
      <DiffersBar key={watch.id} tab={tab} watch={watch} />
    </>
  );
}

interface RunBarProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
}

/** The robot goes by another history than this replica, which takes nothing more. */
function DivergedBar({ watch }: { readonly watch: Watch }) {
  const reason = useComputed(() => {
    const run = watch.now.value?.run;
    return run?.phase === "diverged" ? run.reason : null;
  }, [watch]);
  if (reason === null) return null;
  return (
    <Bar kind="danger" icon={<GitCompareArrows size={16} aria-hidden />}>
      This replica has diverged: {reason}.
    </Bar>
  );
}

function CrashBar({ tab, watch }: RunBarProps) {
  const { page, commands, context } = useSession();
  const isCrashed = useComputed(() => watch.now.value?.run.phase === "crashed", [watch]);
  const why = useLastWords(watch, isCrashed);
  const refusal = useRefusalOf("run.resume-crashed");
  const where = useComputed(() => placesInWords(tab, watch), [tab, watch]);
  if (!isCrashed) return null;
  const run = (policy?: OnCrash) => () =>
    void commands.run("run.resume-crashed", context(), policy);
  const isFront = page.active.peek() === tab;
  const off = { disabled: !isFront || refusal !== null, title: refusal ?? undefined };
  return (
    <Bar
      kind="danger"
      icon={<Skull size={16} aria-hidden />}
      actions={
        <>
          <Button {...off} onClick={run("abort")}>
            Recover: end as aborted
          </Button>
          <Button {...off} onClick={run("restart")}>
            Run again
          </Button>
          <Button {...off} onClick={run()}>
            Decide…
          </Button>
        </>
      }
    >
      The program of this run died{where === "" ? "" : ` in ${where}`}.{why}
    </Bar>
  );
}

/** The names of the innermost states that were active at the end. */
function placesInWords(tab: OpenTab, watch: Watch): string {
  const active = snapshotOf(watch)?.active ?? [];
  const leaves = active.filter(
    ({ path }) => !active.some((other) => other.path.startsWith(`${path}/`)),
  );
  return joinFew(leaves.map(({ path }) => namesTo(tab.session.machine, path).at(-1) ?? path));
}

/** The last line that the program wrote, if it wrote any. */
function useLastWords(watch: Watch, wanted: boolean): string {
  const { page } = useSession();
  const [text, setText] = useState("");
  useEffect(() => {
    if (!wanted) return setText("");
    const get = page.runs.get<{ readonly text: string }>(watch.id, "output?bytes=2000");
    get.then(
      (output) => setText(output.text.trim().split("\n").at(-1) ?? ""),
      () => setText(""),
    );
  }, [page, watch, wanted]);
  return text === "" ? "" : ` Its last output: ${text}`;
}

/** Scripts that a crash has interrupted need a decision. */
function InterruptedBar({ tab, watch }: RunBarProps) {
  const { commands, context } = useSession();
  const paths = useComputed(
    () =>
      (liveRun(tab) === watch ? activeStates(watch) : [])
        .filter(({ phase }) => phase === "interrupted")
        .map(({ path }) => path),
    [tab, watch],
    isSameList,
  );
  if (paths.length === 0) return null;
  const decide = (path: string | null, policy: "abort" | "restart") => () =>
    void commands.run("run.recover", context(), { path, policy });
  return (
    <Bar
      kind="warning"
      icon={<TriangleAlert size={16} aria-hidden />}
      actions={paths.map((path) => {
        const name = namesTo(tab.session.machine, path).at(-1) ?? path;
        return (
          <span key={path} className="bar-choice">
            “{name}”<Button onClick={decide(path, "restart")}>Run again</Button>
            <Button onClick={decide(path, "abort")}>End as aborted</Button>
          </span>
        );
      })}
    >
      The crash interrupted {paths.length === 1 ? "a script" : `${paths.length} scripts`}. What
      should happen to {paths.length === 1 ? "it" : "them"}?
    </Bar>
  );
}

/** The machine on the canvas is not the one that the run goes by. */
function DiffersBar({ tab, watch }: RunBarProps) {
  const { page, commands, context } = useSession();
  const differs = useSignal(differsFromRun(tab, watch, page.runs));
  const canReload = useRefusalOf("run.reload") === null;
  const isLive = useComputed(() => liveRun(tab) === watch, [tab, watch]);
  const [closed, setClosed] = useState(false);
  if (!differs || closed) return null;
  return (
    <Bar
      icon={<GitCompareArrows size={16} aria-hidden />}
      actions={
        <>
          <Button onClick={() => commands.run("run.show-as-ran", context())}>
            Show the machine as it ran
          </Button>
          {canReload && (
            <Button onClick={() => commands.run("run.reload", context())}>
              Apply edits to the run
            </Button>
          )}
          <Button onClick={() => setClosed(true)}>Hide</Button>
        </>
      }
    >
      This machine has been edited since: the run {isLive ? "uses" : "used"} another version.
    </Bar>
  );
}
