/** Panels about the active machine or about its run, each with a text while there is none. */

import type { FunctionComponent, ReactNode } from "react";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { Empty } from "../../ui/empty.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab } from "../context.tsx";
import { NoRun } from "./no_run.tsx";

export interface TabPanelProps {
  readonly tab: OpenTab;
}

export interface RunPanelProps extends TabPanelProps {
  readonly watch: Watch;
}

/** Content of a panel without a subject, or a text about its usual content. */
type Otherwise = string | ReactNode;

/** Panel of the active machine. Each machine has its own instance. */
export function forTab(
  Panel: FunctionComponent<TabPanelProps>,
  otherwise: Otherwise,
): FunctionComponent {
  return function PanelOfTab() {
    const tab = useActiveTab();
    if (tab) return <Panel key={tab.session.id} tab={tab} />;
    if (typeof otherwise !== "string") return otherwise;
    return <Empty title="No machine is open" text={otherwise} />;
  };
}

/** Panel of the active machine's run. Each run of each machine has its own instance. */
export function forRun(
  Panel: FunctionComponent<RunPanelProps>,
  withoutRun: Otherwise,
  withoutMachine?: Otherwise,
): FunctionComponent {
  const noRun = typeof withoutRun === "string" ? <NoRun what={withoutRun} /> : withoutRun;
  function PanelOfRun({ tab }: TabPanelProps) {
    const watch = useSignal(tab.run);
    return watch ? <Panel key={watch.id} tab={tab} watch={watch} /> : noRun;
  }
  return forTab(PanelOfRun, withoutMachine ?? noRun);
}
