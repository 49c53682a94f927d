/** Global variables: all names that scripts of the machine set or read, with their uses. */

import { Pencil } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { type GlobalUse, type GlobalVariable, globalsOf } from "../../model/globals.ts";
import { type Machine, namesTo } from "../../model/machine.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { scriptLineRevealRequest } from "../../store/page/reveal_requests.ts";
import { mayEdit } from "../../store/page/rights.ts";
import { select } from "../../store/page/view.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import type { TreeSource } from "../../ui/tree_rows.ts";
import { useHost } from "../context.tsx";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { InRun } from "./in_run.tsx";
import { RenameGlobal } from "./rename_global.tsx";
import { countsInWords, found, placeInWords } from "./words.ts";
import "./globals.css";

/** Row of the list: a variable, or one of its uses. */
type GlobalNode = {
  readonly id: string;
  readonly variable: GlobalVariable;
  readonly use?: GlobalUse;
};

/** Delay after an edit until the scripts are scanned, in ms. */
const PATIENCE_MS = 200;

export const Globals = forTab(GlobalsOfTab, "Global variables of the open machine appear here.");

function GlobalsOfTab({ tab }: TabPanelProps) {
  const { page } = useHost().context();
  const all = useGlobals(tab);
  const watch = useSignal(tab.run);
  const [query, setQuery] = useState("");
  const [chosen, setChosen] = useState<string | null>(null);
  const [renaming, setRenaming] = useState<GlobalVariable | null>(null);
  if (!all) return <p className="globals-reading">Reading the scripts…</p>;
  const current = all.find(({ name }) => name === chosen) ?? null;
  if (all.length === 0) {
    return watch ? (
      <div className="globals">
        <InRun watch={watch} query="" />
      </div>
    ) : (
      <Empty
        title="No global variables"
        text='Scripts share values with gvm.set_variable("name", value) and gvm.get_variable("name"). Each name appears here with its uses.'
      />
    );
  }
  return (
    <div className="globals">
      <div className="globals-bar">
        <TextField
          label="Filter global variables"
          hideLabel
          type="search"
          placeholder="Filter"
          value=""
          onInput={setQuery}
        />
        <IconButton
          label={current ? `Rename ${current.name}` : "Rename: choose a variable first"}
          icon={<Pencil size={14} />}
          disabled={!current || !mayEdit(page)}
          onClick={() => setRenaming(current)}
        />
      </div>
      <Variables
        tab={tab}
        variables={found(all, query)}
        chosen={chosen}
        onChoose={setChosen}
        onRename={setRenaming}
      />
      {watch && <InRun key={watch.id} watch={watch} query={query} />}
      {renaming && (
        <RenameGlobal
          page={page}
          tab={tab}
          variable={renaming}
          taken={all.map(({ name }) => name)}
          onClose={() => setRenaming(null)}
        />
      )}
    </div>
  );
}

/** Variables after a pause in the edits; null before the first scan. */
function useGlobals({ session }: OpenTab): readonly GlobalVariable[] | null {
  const [all, setAll] = useState<readonly GlobalVariable[] | null>(null);
  useEffect(() => {
    let timer = 0;
    const stop = session.version.subscribe(() => {
      window.clearTimeout(timer);
      timer = window.setTimeout(() => setAll(globalsOf(session.machine)), PATIENCE_MS);
    });
    return () => {
      stop();
      window.clearTimeout(timer);
    };
  }, [session]);
  return all;
}

interface VariablesProps {
  readonly tab: OpenTab;
  readonly variables: readonly GlobalVariable[];
  readonly chosen: string | null;
  readonly onChoose: (name: string) => void;
  readonly onRename: (variable: GlobalVariable) => void;
}

function Variables({ tab, variables, chosen, onChoose, onRename }: VariablesProps) {
  const host = useHost();
  const { machine } = tab.session;
  const [expanded, setExpanded] = useState<ReadonlySet<string>>(new Set());
  const roots = useMemo<readonly GlobalNode[]>(
    () => variables.map((variable) => ({ id: variable.name, variable })),
    [variables],
  );
  const source: TreeSource<GlobalNode> = { roots, id: idOf, childrenOf: inside, expanded };
  const show = ({ use }: GlobalNode) => {
    if (!use) return;
    select(tab.view, [{ kind: "state", path: use.path }]);
    host.context().canvas?.reveal({ kind: "state", path: use.path });
    if (use.line !== null) scriptLineRevealRequest.value = { path: use.path, line: use.line };
  };
  const expand = ({ id }: GlobalNode, open: boolean) => {
    const next = new Set(expanded);
    if (open) next.add(id);
    else next.delete(id);
    setExpanded(next);
  };
  return (
    <Tree
      label="Global variables"
      {...source}
      text={(node) => textOf(machine, node)}
      row={(node) => <Row machine={machine} node={node} />}
      selected={new Set(chosen === null ? [] : [chosen])}
      onExpand={expand}
      onSelect={(node) => {
        onChoose(node.variable.name);
        show(node);
      }}
      onOpen={(node) => (node.use ? show(node) : expand(node, !expanded.has(node.id)))}
      onHover={(node) => {
        tab.view.hovered.value = node?.use ? { kind: "state", path: node.use.path } : null;
      }}
      onKey={({ variable }, event) => {
        if (event.key === "F2") onRename(variable);
      }}
    />
  );
}

function idOf({ id }: GlobalNode): string {
  return id;
}

function inside({ variable, use, id }: GlobalNode): readonly GlobalNode[] | null {
  if (use) return null;
  return variable.uses.map((each, index) => ({ id: `${id}\n${index}`, variable, use: each }));
}

function textOf(machine: Machine, { variable, use }: GlobalNode): string {
  return use ? placeInWords(machine, use) : `${variable.name} ${countsInWords(variable)}`;
}

function Row({ machine, node: { variable, use } }: { machine: Machine; node: GlobalNode }) {
  if (!use) {
    return (
      <span className="globals-row">
        <code>{variable.name}</code> <span className="globals-soft">{countsInWords(variable)}</span>
      </span>
    );
  }
  const names = namesTo(machine, use.path);
  return (
    <span className="globals-row" title={`${names.join(" / ")}\n${use.text}`}>
      <span className={`globals-access globals-${use.access}`}>{use.access}</span>{" "}
      <span>
        {names.at(-1)}
        {use.line !== null && `:${use.line}`}
      </span>{" "}
      <code className="globals-soft">{use.text}</code>
    </span>
  );
}
