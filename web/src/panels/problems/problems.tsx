/** Problems of the active machine, each with its location and available repairs. */

import { CircleAlert, CircleCheck, Info, TriangleAlert, Wrench } from "lucide-react";
import { useMemo, useState } from "react";
import type { MachineProblem, Repair } from "../../model/generated/protocol.ts";
import { type Machine, namesTo } from "../../model/machine.ts";
import { byWeight, elementOfProblem, withoutPlace } from "../../model/problem.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { scriptLineRevealRequest } from "../../store/page/reveal_requests.ts";
import { mayEdit } from "../../store/page/rights.ts";
import { Button } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { useHost } from "../context.tsx";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { reveal } from "../reveal.ts";
import "./problems.css";

export const Problems = forTab(ProblemsOfTab, "Problems of the open machine appear here.");

function idOf({ path, part, rule, message }: MachineProblem): string {
  return [path, part, rule, message].join("\n");
}

function ProblemsOfTab({ tab }: TabPanelProps) {
  const host = useHost();
  const problems = useSignal(tab.session.problems);
  const [query, setQuery] = useState("");
  const [chosen, setChosen] = useState<string | null>(null);
  const { machine } = tab.session;
  const rows = useMemo(() => byWeight(problems).filter(matching(query)), [problems, query]);
  const columns = useMemo(
    () => columnsOf(machine, (text) => tab.session.named(text)),
    [machine, tab],
  );
  if (problems.length === 0) return <NoneFound tab={tab} />;
  const problem = rows.find((each) => idOf(each) === chosen);
  return (
    <div className="problems">
      <div className="problems-bar">
        <TextField
          label="Filter problems"
          hideLabel
          type="search"
          placeholder="Filter"
          value=""
          onInput={setQuery}
        />
        <span className="problems-soft">{inWords(problems)}</span>
      </div>
      <div className="problems-rows">
        <Table
          label="Problems, most severe first"
          columns={columns}
          rows={rows}
          id={idOf}
          selected={new Set(chosen === null ? [] : [chosen])}
          onSelect={(each) => {
            setChosen(idOf(each));
            reveal(host, elementOfProblem(each));
            if (each.line != null)
              scriptLineRevealRequest.value = { path: each.path, line: each.line };
          }}
        />
      </div>
      {problem && <Chosen tab={tab} problem={problem} />}
    </div>
  );
}

/** Shown without problems. The text depends on whether the machine was checked. */
function NoneFound({ tab }: { readonly tab: OpenTab }) {
  const isChecked = useSignal(tab.session.isChecked);
  if (tab.session.fixed !== null) {
    return (
      <Empty
        title="Not checked"
        text="This is the machine of a run. Open the machine itself to check it."
      />
    );
  }
  return isChecked ? (
    <Empty
      icon={<CircleCheck size={22} />}
      title="No problems"
      text="Rules, files and scripts are fine. Every edit is checked."
    />
  ) : (
    <Empty title="Checking…" text="Rules, files and scripts are being checked." />
  );
}

function Chosen({ tab, problem }: { readonly tab: OpenTab; readonly problem: MachineProblem }) {
  const may = mayEdit(useHost().context().page);
  const [isBusy, setBusy] = useState(false);
  const mend = async ({ name, edit }: Repair) => {
    setBusy(true);
    await tab.session.edit(name, edit);
    setBusy(false);
  };
  return (
    <section className="problems-chosen" aria-label="Selected problem">
      <p>{tab.session.named(problem.message)}</p>
      {(problem.repairs ?? []).map((repair) => (
        <Button
          key={repair.name}
          icon={<Wrench size={14} />}
          disabled={!may || isBusy}
          onClick={() => void mend(repair)}
        >
          {repair.name}
        </Button>
      ))}
    </section>
  );
}

const ICONS = { error: CircleAlert, warning: TriangleAlert, note: Info };

function columnsOf(
  machine: Machine,
  named: (text: string) => string,
): readonly TableColumn<MachineProblem>[] {
  return [
    {
      key: "severity",
      title: "",
      width: "92px",
      cell: ({ severity }) => {
        const Icon = ICONS[severity];
        return (
          <span className={`problems-severity problems-${severity}`}>
            <Icon size={14} aria-hidden />
            {severity}
          </span>
        );
      },
    },
    {
      key: "message",
      title: "What",
      width: "minmax(160px, 3fr)",
      cell: (problem) => (
        <span title={named(problem.message)}>
          {problem.repairs && problem.repairs.length > 0 && (
            <Wrench size={12} aria-label="can be repaired" style={{ marginRight: 4 }} />
          )}
          {named(withoutPlace(problem))}
        </span>
      ),
    },
    {
      key: "where",
      title: "Where",
      width: "minmax(100px, 1fr)",
      cell: ({ path, part }) => (
        <span className="problems-soft">
          {namesTo(machine, path).join(" / ")}
          {part === "state" ? "" : ` · ${part}`}
        </span>
      ),
    },
  ];
}

function matching(query: string): (problem: MachineProblem) => boolean {
  const wanted = query.trim().toLowerCase();
  return ({ message, path, part, rule }) =>
    [message, path, part, rule].some((text) => text.toLowerCase().includes(wanted));
}

/** Such as `2 errors, 1 warning`. */
function inWords(problems: readonly MachineProblem[]): string {
  const count = (severity: string) =>
    problems.filter((problem) => problem.severity === severity).length;
  return (["error", "warning", "note"] as const)
    .map((severity) => ({ severity, many: count(severity) }))
    .filter(({ many }) => many > 0)
    .map(({ severity, many }) => `${many} ${severity}${many === 1 ? "" : "s"}`)
    .join(", ");
}
