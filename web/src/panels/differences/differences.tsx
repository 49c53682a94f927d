/** Differences between the active machine and the file on disk, an earlier version, or the machine of another tab. */

import { RefreshCw } from "lucide-react";
import { useEffect, useState } from "react";
import type { Difference } from "../../model/difference.ts";
import type { MachineVersions } from "../../model/generated/protocol.ts";
import { comparisonOf, type MachineComparison } from "../../store/page/comparison.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { RefusalError } from "../../store/page/server.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { Checkbox, Select } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { DifferenceList } from "../difference_list.tsx";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { reveal } from "../reveal.ts";
import { againstOptions, optionOf } from "./against.ts";
import "./differences.css";

export const Differences = forTab(
  DifferencesOfTab,
  "Differences between the open machine and its files, an earlier version or another machine appear here.",
);

function DifferencesOfTab({ tab }: TabPanelProps) {
  const { page } = useHost().context();
  const comparison = comparisonOf(tab, page.server);
  const against = useSignal(comparison.against);
  const versions = useVersions(tab);
  const tabs = useSignal(page.tabs);
  const found = useSignal(comparison.found);
  const [hasLayout, setLayout] = useState(false);
  const options = againstOptions(tabs, tab, versions);
  const isGone = against?.kind === "tab" && !tabs.includes(against.tab);
  useEffect(() => {
    if (isGone) void comparison.choose(null);
  }, [isGone, comparison]);
  const shown = hasLayout ? found : found.filter(({ isLayout }) => !isLayout);
  const choose = (value: string) => {
    const option = options.find((each) => each.value === value);
    void comparison.choose(option?.against ?? null);
  };
  return (
    <div className="differences">
      <div className="differences-bar">
        <Select
          label="Compare with"
          hideLabel
          value={optionOf(against)}
          options={options.map(({ value, title }) => ({
            value,
            title: value === "" ? "Compare with…" : title,
          }))}
          onChange={choose}
        />
        <IconButton
          label="Compare again"
          icon={<RefreshCw size={15} />}
          disabled={!against}
          onClick={() => void comparison.refresh()}
        />
        <Checkbox label="Positions on the canvas" checked={hasLayout} onChange={setLayout} />
        {against && <span className="differences-count">{counted(shown)}</span>}
      </div>
      <Found tab={tab} comparison={comparison} shown={shown} />
    </div>
  );
}

interface DifferencesProps {
  readonly tab: OpenTab;
  readonly comparison: MachineComparison;
  readonly shown: readonly Difference[];
}

function Found({ tab, comparison, shown }: DifferencesProps) {
  const host = useHost();
  const against = useSignal(comparison.against);
  const other = useSignal(comparison.other);
  const refusal = useSignal(comparison.refusal);
  if (!against) {
    return (
      <Empty
        title="No comparison"
        text="Differences are listed here and marked on the canvas."
        action={{
          title: "Compare with the version on disk",
          onClick: () => void comparison.choose({ kind: "saved" }),
        }}
      />
    );
  }
  if (refusal) {
    return (
      <p className="differences-refusal" role="alert">
        {refusal}
      </p>
    );
  }
  if (!other) return <p className="differences-count">Reading…</p>;
  if (shown.length === 0) {
    return <Empty title="No differences" text="Both machines are identical." />;
  }
  return (
    <DifferenceList
      label="Differences"
      all={shown}
      old={other}
      now={tab.session.machine}
      onReveal={({ element }) => reveal(host, element)}
    />
  );
}

/** Versions of the machine in git, requested again after each save. */
function useVersions(tab: OpenTab): MachineVersions | null {
  const { server } = useHost().context().page;
  const saved = useSignal(tab.session.status)?.summary.saved_revision;
  const [versions, setVersions] = useState<MachineVersions | null>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: a save may have created a commit
  useEffect(() => {
    let isGone = false;
    const path = `/machines/${encodeURIComponent(tab.session.id)}/versions`;
    server.request<MachineVersions>("GET", path).then(
      (answer) => {
        if (!isGone) setVersions(answer);
      },
      (error: unknown) => {
        if (!(error instanceof RefusalError)) throw error;
      },
    );
    return () => {
      isGone = true;
    };
  }, [server, tab, saved]);
  return versions;
}

/** Such as `1 added, 3 changed`. */
function counted(all: readonly Difference[]): string {
  const counts = (["added", "removed", "changed"] as const)
    .map((kind) => ({ kind, many: all.filter((each) => each.kind === kind).length }))
    .filter(({ many }) => many > 0)
    .map(({ kind, many }) => `${many.toLocaleString("en")} ${kind}`);
  return counts.join(", ");
}
