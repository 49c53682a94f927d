/** Mission control: status of the mission and the most important actions, for operators under stress. */

import { signal } from "@preact/signals-core";
import { HardDrive } from "lucide-react";
import { useEffect, useRef } from "react";
import type { Watch } from "../../store/history/run.ts";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useActiveTab } from "../context.tsx";
import { Attention } from "./attention.tsx";
import { Branches } from "./branches.tsx";
import { ControlPart } from "./control.tsx";
import { Crash } from "./crash.tsx";
import { Events } from "./events.tsx";
import { Head } from "./head.tsx";
import { NoRun } from "./no_run.tsx";
import { Pinned } from "./pinned.tsx";
import { Questions } from "./questions.tsx";
import { RobotLink } from "./robot_link.tsx";
import { SentList } from "./sent_list.tsx";
import { Steering, WhyNot } from "./steering.tsx";
import "./mission.css";
import "./head.css";
import "./steering.css";
import "./cards.css";
import "./events.css";

const NO_RUN = signal<Watch | null>(null);

export function Mission() {
  const tab = useActiveTab();
  const watch = useSignal(tab?.run ?? NO_RUN);
  const place = useRef<HTMLDivElement>(null);
  // The list of runs may have been scrolled. Another run is shown from its head.
  // biome-ignore lint/correctness/useExhaustiveDependencies: runs again for another run
  useEffect(() => place.current?.closest(".panel")?.scrollTo?.(0, 0), [watch?.id]);
  return (
    <div ref={place} className="mission">
      {watch ? <Shown key={watch.id} watch={watch} /> : <NoRun />}
    </div>
  );
}

function Shown({ watch }: { readonly watch: Watch }) {
  return (
    <>
      <div className="mission-top">
        <Head watch={watch} />
        <RobotLink watch={watch} />
        <Steering />
        <Attention watch={watch} />
        <div className="mission-notes">
          <WhyNot watch={watch} />
          <JournalProblem watch={watch} />
        </div>
        <SentList watch={watch} />
      </div>
      <div className="mission-facts">
        <Questions watch={watch} />
        <Crash watch={watch} />
        <ControlPart watch={watch} />
        <Branches watch={watch} />
        <Pinned watch={watch} />
        <Events watch={watch} />
      </div>
    </>
  );
}

function JournalProblem({ watch }: { readonly watch: Watch }) {
  const problem = useComputed(() => watch.now.value?.snapshot?.journal_problem ?? null, [watch]);
  if (problem === null) return null;
  return (
    <p className="mission-band mission-band-old" role="alert">
      <HardDrive size={16} aria-hidden />
      <span>The journal can no longer be written: {problem}</span>
    </p>
  );
}
