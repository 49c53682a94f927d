/** Comparison of two runs: the points where they differ, differences in data, and durations of states. A click shows the entry in
 * its run, at its moment. */

import { computed, effect } from "@preact/signals-core";
import { GitCompare, RefreshCw, X } from "lucide-react";
import { useEffect, useState } from "react";
import { keyOf } from "../../model/element.ts";
import type { Comparison, Parting, RunSummary } from "../../model/generated/protocol.ts";
import { statusInWords, summaryStatusWords } from "../../model/run_words.ts";
import { comparedRun } from "../../store/history/compared_run.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { wallTime } from "../../store/page/times.ts";
import { runsOfTab } from "../../store/run/running.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { Select } from "../../ui/field.tsx";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { forRun, type RunPanelProps } from "../parts/for_tab.tsx";
import { comparedOf, compareNow } from "../parts/parted.ts";
import { AroundDifference } from "./around_difference.tsx";
import { Branches } from "./branches.tsx";
import { Changed } from "./changed.tsx";
import type { ShowCompared } from "./show.ts";
import { TimingTable } from "./timing_table.tsx";
import "./compare.css";

export const Compare = forRun(
  CompareOfRun,
  "Compare it with another run to see where they diverge, and why.",
  "Two runs of the open machine appear here side by side.",
);

function CompareOfRun({ tab, watch }: RunPanelProps) {
  const { page } = useHost().context();
  const compared = useSignal(comparedOf(watch));
  useComparison(page, watch);
  useMarks(tab, compared?.comparison ?? null);
  return (
    <section className="compare" aria-label="Comparison of two runs">
      <Chooser tab={tab} watch={watch} page={page} />
      {compared?.refusal && <p className="compare-refusal">{compared.refusal}</p>}
      {compared?.comparison && (
        <Found tab={tab} watch={watch} other={compared.other} comparison={compared.comparison} />
      )}
      {!compared && (
        <Empty
          icon={<GitCompare size={22} />}
          title="Choose another run"
          text="See where the two first diverge, which data differed before, and how long each state took."
        />
      )}
    </section>
  );
}

/** Requests the comparison when another run is chosen, and again when one of the two ends. */
function useComparison(page: Page, watch: Watch): void {
  useEffect(() => {
    const both = computed(() => {
      const other = comparedRun(watch).value;
      const phase = page.runs.all.value.find(({ id }) => id === other)?.phase;
      return `${other} ${phase} ${watch.now.value?.link === "over"}`;
    });
    return effect(() => {
      both.value;
      void compareNow(page, watch);
    });
  }, [page, watch]);
}

/** Marks the states at which the runs differ on the canvas while the panel is visible. */
function useMarks({ view }: OpenTab, comparison: Comparison | null): void {
  const parted = comparison?.parted;
  useEffect(() => {
    const steps = (parted ?? []).flatMap(({ one, other }) => [one, other]);
    const paths = steps.flatMap((step) => (step ? [step.path] : []));
    if (paths.length === 0) return;
    const marks = new Map(
      paths.map((path) => [keyOf({ kind: "state", path }), "changed" as const]),
    );
    view.marks.value = marks;
    return () => {
      if (view.marks.peek() === marks) view.marks.value = null;
    };
  }, [view, parted]);
}

interface ChooserProps extends RunPanelProps {
  readonly page: Page;
}

const NONE = "";

function Chooser({ tab, watch, page }: ChooserProps) {
  const all = useSignal(page.runs.all);
  const chosen = useSignal(comparedRun(watch));
  const mine = all.find(({ id }) => id === watch.id);
  const others = runsOfTab(page, tab).filter(({ id }) => id !== watch.id);
  const known = chosen === null || others.some(({ id }) => id === chosen);
  const options = known ? others : [...others, ...all.filter(({ id }) => id === chosen)];
  return (
    <div className="compare-bar">
      <span className="compare-one">
        <span className="compare-side compare-side-one">This run</span>
        {mine ? inWords(mine) : watch.id}
      </span>
      <Select
        label="The other run"
        hideLabel
        value={chosen ?? NONE}
        options={[
          { value: NONE, title: others.length === 0 ? "No other run" : "Choose the other run…" },
          ...options.map((run) => ({ value: run.id, title: inWords(run) })),
        ]}
        onChange={(id) => {
          comparedRun(watch).value = id === NONE ? null : id;
        }}
      />
      <IconButton
        label="Compare again"
        icon={<RefreshCw size={15} />}
        disabled={chosen === null}
        onClick={() => void compareNow(page, watch)}
      />
      <IconButton
        label="Close comparison"
        icon={<X size={15} />}
        disabled={chosen === null}
        onClick={() => {
          comparedRun(watch).value = null;
        }}
      />
    </div>
  );
}

function inWords(run: RunSummary): string {
  return `${wallTime(run.started_ms, Date.now())}, ${statusInWords(summaryStatusWords(run))}`;
}

interface ComparedProps extends RunPanelProps {
  readonly other: string;
  readonly comparison: Comparison;
}

function Found({ tab, watch, other, comparison }: ComparedProps) {
  const { page } = useHost().context();
  const show: ShowCompared = async (side, sequence) => {
    if (side === "one") {
      watch.playhead.value = sequence;
      return;
    }
    const theirs = page.runs.watch(other);
    comparedRun(theirs).value = watch.id;
    comparedOf(theirs).value = null;
    await page.showRun(other);
    theirs.playhead.value = sequence;
  };
  const { alike, parted, branches_parted, changed, timing } = comparison;
  const [branch, setBranch] = useState<string | null>(null);
  const chosen = parted.find((parting) => parting.branch === branch) ?? parted[0];
  const choose = (parting: Parting) => {
    setBranch(parting.branch);
    const { one, other: theirs } = parting;
    if (one) watch.playhead.value = one.sequence;
    if (theirs) page.runs.watch(other).playhead.value = theirs.sequence;
  };
  return (
    <div className="compare-body">
      <p className="compare-words" role="status">
        {parted.length === 0
          ? `The runs do not diverge: ${alike} entries and ends are equal in both.`
          : `${alike} entries and ends are equal in both, then they diverge${
              branches_parted > 1 ? ` on ${branches_parted} branches` : ""
            }.`}
      </p>
      {chosen && parted.length > 1 && (
        <Section title="Diverging branches" count={branches_parted}>
          <Branches parted={parted} chosen={chosen} choose={choose} />
          {branches_parted > parted.length && (
            <p className="compare-soft">Only the {parted.length} earliest are shown.</p>
          )}
        </Section>
      )}
      {chosen && (
        <Section title={titleOf(chosen, parted)}>
          <AroundDifference tab={tab} watch={watch} other={other} parted={chosen} show={show} />
        </Section>
      )}
      <Section title="Data that differed before" count={changed.length}>
        <Changed changed={changed} show={show} />
      </Section>
      <Section title="Time in states" count={timing.length}>
        <TimingTable watch={watch} other={other} timing={timing} show={show} />
      </Section>
    </div>
  );
}

function titleOf(chosen: Parting, [first]: readonly Parting[]): string {
  return chosen === first
    ? "First difference"
    : `Difference on ${chosen.names.split("/").at(-1) ?? chosen.branch}`;
}
