/** Branches on which two runs differ, each with its first difference, the earliest first. */

import type { Happened, Parting } from "../../model/generated/protocol.ts";
import { missionTime } from "../../store/page/times.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";

interface BranchesProps {
  readonly parted: readonly Parting[];
  /** Branch with the displayed difference. */
  readonly chosen: Parting;
  /** Shows the difference in both runs. */
  readonly choose: (parting: Parting) => void;
}

const ROWS_MAX = 8;

export function Branches({ parted, chosen, choose }: BranchesProps) {
  const side = (key: "one" | "other", title: string): TableColumn<Parting> => ({
    key,
    title,
    width: "minmax(130px, 3fr)",
    cell: (row) => <Step step={row[key]} />,
  });
  return (
    <Table
      label="Branches where the runs diverge"
      columns={[
        {
          key: "branch",
          title: "Branch",
          width: "minmax(110px, 2fr)",
          cell: (row) => <Branch row={row} isFirst={row === parted[0]} />,
        },
        side("one", "This run"),
        side("other", "Other run"),
      ]}
      rows={parted}
      id={({ branch }) => branch}
      selected={new Set([chosen.branch])}
      onSelect={choose}
      onOpen={choose}
      rowsMax={ROWS_MAX}
    />
  );
}

function Branch({ row: { names }, isFirst }: { readonly row: Parting; readonly isFirst: boolean }) {
  return (
    <span title={names.split("/").join(" / ")}>
      {nameIn(names)}
      {isFirst && <span className="compare-first"> first</span>}
    </span>
  );
}

function Step({ step }: { readonly step: Happened | null }) {
  const words = stepInWords(step);
  return (
    <span title={words}>
      {words}
      {step && <span className="compare-when"> {missionTime(step.t_ns)}</span>}
    </span>
  );
}

/** Such as `Look ended with seen`. */
export function stepInWords(step: Happened | null): string {
  if (!step) return "no further events";
  const name = nameIn(step.names);
  if (!step.outcome) return `${name} entered${step.backwards ? " backwards" : ""}`;
  return step.backwards ? `${name} undone` : `${name} ended with ${step.outcome.name}`;
}

function nameIn(names: string): string {
  return names.split("/").at(-1) ?? names;
}
