/** Modification history: all steps of the machine as a tree. Any step can be restored. */

import { CornerUpLeft, Redo2, Undo2 } from "lucide-react";
import { useMemo, useState } from "react";
import { type StepRow, stepRows, stepTree } from "../../model/steps.ts";
import { mayEdit } from "../../store/page/rights.ts";
import { wallTime } from "../../store/page/times.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Checkbox } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { useCommand, useHost } from "../context.tsx";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { Graph, graphWidth } from "./graph.tsx";
import { jumpTo } from "./jump.ts";
import { StepDetail } from "./step_detail.tsx";
import "./edits.css";

export const Edits = forTab(EditsOfTab, "All edits of the open machine appear here.");

function EditsOfTab({ tab }: TabPanelProps) {
  const host = useHost();
  const run = useCommand();
  const steps = useSignal(tab.session.steps);
  const saved = useSignal(tab.session.status)?.summary.saved_revision;
  const [hasBranches, setBranches] = useState(true);
  const [chosen, setChosen] = useState<number | null>(null);
  const tree = useMemo(() => stepTree(steps), [steps]);
  const rows = useMemo(() => stepRows(tree, hasBranches), [tree, hasBranches]);
  const may = mayEdit(host.context().page);
  const node = chosen === null ? undefined : tree.nodes.get(chosen);
  const isKept = node !== undefined && (node.step?.is_kept ?? true);
  const canJump = may && isKept && chosen !== tree.current;
  const jump = (revision: number) => void jumpTo(host, tab, revision);
  return (
    <div className="edits">
      <div className="edits-bar">
        <IconButton
          label="Undo your last step"
          keys="Ctrl+Z"
          icon={<Undo2 size={15} />}
          disabled={!may}
          onClick={() => run("edit.undo")}
        />
        <IconButton
          label="Redo"
          keys="Ctrl+Y"
          icon={<Redo2 size={15} />}
          disabled={!may}
          onClick={() => run("edit.redo")}
        />
        <Checkbox label="Branches" checked={hasBranches} onChange={setBranches} />
        <span className="edits-gap" />
        <Button
          icon={<CornerUpLeft size={14} />}
          title="Restores the machine as it was after the chosen step. You can undo this."
          disabled={!canJump}
          onClick={() => chosen !== null && jump(chosen)}
        >
          Go to this step
        </Button>
      </div>
      <div className="edits-body">
        <div className="edits-rows">
          <Table
            label="Steps, newest first"
            columns={columnsOf(rows, tree.current, saved)}
            rows={rows}
            id={(row) => String(row.node.revision)}
            selected={new Set(chosen === null ? [] : [String(chosen)])}
            onSelect={(row) => setChosen(row.node.revision)}
            onOpen={(row) => may && row.node.revision !== tree.current && jump(row.node.revision)}
          />
        </div>
        {node && <StepDetail key={node.revision} tab={tab} node={node} />}
      </div>
    </div>
  );
}

/** Horizontal padding of a cell, in CSS pixels. */
const CELL_PADDING_PX = 16;

const PLACES = {
  current: "current step",
  done: "",
  undone: "undone",
  branch: "on another branch",
} as const;

function columnsOf(
  rows: readonly StepRow[],
  current: number,
  saved: number | undefined,
): readonly TableColumn<StepRow>[] {
  const now_ms = Date.now();
  return [
    {
      key: "graph",
      title: "",
      width: `${graphWidth(rows) + CELL_PADDING_PX}px`,
      cell: (row) => <Graph row={row} />,
    },
    {
      key: "name",
      title: "Step",
      width: "minmax(120px, 2fr)",
      cell: ({ node: { step, revision }, place }) => (
        <span className={`edits-${place}`} title={PLACES[place]}>
          {step === null ? "As it was opened" : nameOf(step.kind, step.name)}
          {place === "undone" && <span className="visually-hidden"> (undone)</span>}
          {revision === current && <span className="edits-saved">now</span>}
          {revision === saved && <span className="edits-saved">saved</span>}
        </span>
      ),
    },
    {
      key: "author",
      title: "User",
      width: "minmax(60px, 1fr)",
      cell: ({ node: { step } }) => step?.author ?? "",
    },
    {
      key: "time",
      title: "When",
      width: "110px",
      align: "right",
      cell: ({ node: { step } }) =>
        step && <span className="edits-time">{wallTime(step.at_ms, now_ms)}</span>,
    },
  ];
}

/** Name of a step, with a prefix for steps that only undo, redo or jump. */
function nameOf(kind: string, name: string): string {
  switch (kind) {
    case "undo":
      return `Undo: ${name}`;
    case "redo":
      return `Redo: ${name}`;
    default:
      return name;
  }
}
