/** Mission control: how the mission stands for somebody under stress, and the few things that such a person does. */

import { signal } from "@preact/signals-core";
import type { Watch } from "../../store/run.ts";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab } from "../context.tsx";
import { Branches } from "./branches.tsx";
import { ControlPart } from "./control.tsx";
import { Crash } from "./crash.tsx";
import { Events } from "./events.tsx";
import { Head } from "./head.tsx";
import { NoRun } from "./no_run.tsx";
import { Pinned } from "./pinned.tsx";
import { Questions } from "./questions.tsx";
import { Steering } from "./steering.tsx";
import "./mission.css";
import "./head.css";
import "./steering.css";
import "./cards.css";
import "./events.css";

const NO_RUN = signal<Watch | null>(null);

export function Mission() {
  const tab = useActiveTab();
  const watch = useSignal(tab?.run ?? NO_RUN);
  return (
    <div className="mission">{watch ? <Shown key={watch.id} watch={watch} /> : <NoRun />}</div>
  );
}

function Shown({ watch }: { readonly watch: Watch }) {
  return (
    <>
      <div className="mission-top">
        <Head watch={watch} />
        <Steering watch={watch} />
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
