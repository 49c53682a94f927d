/** Libraries that machines can use. They can be dragged into a machine, opened, substituted for a state, or searched for uses. */

import { ChevronsDownUp, Folder, FolderTree, Library as LibrarySign } from "lucide-react";
import { type DragEvent, useEffect, useMemo, useState } from "react";
import { openLibraryMachine } from "../../commands/library_machine.ts";
import type { LibraryName } from "../../model/generated/protocol.ts";
import type { Point } from "../../model/geometry.ts";
import { lineage } from "../../model/path.ts";
import { DRAGGED_TYPE, type Dragged, dragged } from "../../store/page/dragged.ts";
import { libraryRevealRequest } from "../../store/page/reveal_requests.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { Marked } from "../../ui/marked.tsx";
import { ContextMenu } from "../../ui/menu.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import { useActiveTab, useHost } from "../context.tsx";
import { About } from "./about.tsx";
import { Changed } from "./changed.tsx";
import { libraryMenu } from "./menu.ts";
import { foldersIn, type LibraryTreeNode, matching, nodesOf } from "./nodes.ts";
import { Usages } from "./usages.tsx";
import "./libraries.css";

interface Menu {
  readonly at: Point;
  readonly library: LibraryName;
}

export function Libraries() {
  const host = useHost();
  const { page } = host.context();
  const tab = useActiveTab();
  const roots = useSignal(page.libraries);
  const [query, setQuery] = useState("");
  const [chosen, setChosen] = useState<LibraryName | null>(null);
  const [used, setUsed] = useState<LibraryName | null>(null);
  const [menu, setMenu] = useState<Menu | null>(null);
  const [open, setOpen] = useState<ReadonlySet<string> | null>(null);
  const nodes = useMemo(() => nodesOf(roots), [roots]);
  const wanted = useSignal(libraryRevealRequest);
  useEffect(() => {
    if (!wanted) return;
    setQuery("");
    setChosen(wanted);
    setUsed(null);
    const around = lineage(wanted.path);
    setOpen((before) => new Set([...(before ?? nodes.map(({ key }) => key)), ...around]));
  }, [wanted, nodes]);
  const shown = useMemo(() => matching(nodes, query), [nodes, query]);
  const expanded = useMemo(
    () => (shown === nodes ? (open ?? new Set(nodes.map(({ key }) => key))) : foldersIn(shown)),
    [shown, nodes, open],
  );
  if (roots.length === 0) return <NoLibraries />;
  const choose = (library: LibraryName | null) => {
    setChosen(library);
    if (library?.path !== used?.path || library?.name !== used?.name) setUsed(null);
  };
  return (
    <div className="libraries">
      <LibraryBar
        key={wanted ? `${wanted.path}/${wanted.name}` : ""}
        onQuery={setQuery}
        onFold={() => setOpen(new Set())}
      />
      {tab && <Changed key={tab.session.id} tab={tab} />}
      {shown.length === 0 ? (
        <Empty title="No library" text={`No library or folder name contains “${query}”.`} />
      ) : (
        <Tree
          label="Libraries"
          roots={shown}
          id={({ key }) => key}
          childrenOf={({ children }) => children}
          expanded={expanded}
          text={({ name }) => name}
          row={(node) => <Row node={node} />}
          onExpand={({ key }, isOpen) => setOpen(changed(expanded, key, isOpen))}
          selected={new Set(chosen ? [`${chosen.path}/${chosen.name}`] : [])}
          reveal={wanted && `${wanted.path}/${wanted.name}`}
          onSelect={({ library }) => choose(library)}
          onOpen={({ key, library }) => {
            if (library) void openLibraryMachine(page, library);
            else setOpen(changed(expanded, key, !expanded.has(key)));
          }}
          onMenu={({ library }, at) => {
            choose(library);
            if (library) setMenu({ at, library });
          }}
          draggable={({ library }) => library !== null}
          onDragStart={({ library }, event) => library && drag(library, event)}
          onDragEnd={() => {
            dragged.value = null;
          }}
        />
      )}
      {chosen && !used && <About library={chosen} />}
      {used && <Usages library={used} onClose={() => setUsed(null)} />}
      {menu && (
        <ContextMenu
          label={`Actions for ${menu.library.name}`}
          at={menu.at}
          items={libraryMenu(host, menu.library, setUsed)}
          onClose={() => setMenu(null)}
        />
      )}
    </div>
  );
}

function NoLibraries() {
  return (
    <Empty
      icon={<LibrarySign size={22} />}
      title="No libraries"
      text="Machines in library roots can be used as states. List the roots under LIBRARY_PATHS in config.yaml, or start the server with --library-path name=folder."
    />
  );
}

interface LibraryBarProps {
  readonly onQuery: (query: string) => void;
  readonly onFold: () => void;
}

function LibraryBar({ onQuery, onFold }: LibraryBarProps) {
  return (
    <div className="libraries-bar">
      <TextField
        label="Filter libraries"
        hideLabel
        type="search"
        placeholder="Filter libraries"
        value=""
        onInput={onQuery}
      />
      <IconButton label="Fold all" icon={<ChevronsDownUp size={14} />} onClick={onFold} />
    </div>
  );
}

function changed(before: ReadonlySet<string>, key: string, isOpen: boolean): ReadonlySet<string> {
  const now = new Set(before);
  if (isOpen) now.add(key);
  else now.delete(key);
  return now;
}

function drag({ path, name }: LibraryName, event: DragEvent<HTMLElement>): void {
  const what: Dragged = { library: { path, name } };
  dragged.value = what;
  event.dataTransfer.setData(DRAGGED_TYPE, JSON.stringify(what));
  event.dataTransfer.effectAllowed = "copy";
}

function Row({ node }: { readonly node: LibraryTreeNode }) {
  const Icon = node.library ? LibrarySign : node.folder === null ? Folder : FolderTree;
  return (
    <span className="libraries-row" title={node.folder ?? node.key}>
      <Icon size={14} aria-hidden />
      <span className="libraries-cut">
        <Marked text={node.name} spans={node.spans} />
      </span>
    </span>
  );
}
