/** Active machine as a tree of states, for searching, selecting, and rearranging by its menu. */

import { ListTree } from "lucide-react";
import { type ReactNode, useCallback, useEffect, useMemo, useState } from "react";
import { type ElementKey, elementOf } from "../../model/element.ts";
import type { Point } from "../../model/geometry.ts";
import { type Machine, startOf } from "../../model/machine.ts";
import type { TextSpan } from "../../model/match.ts";
import { inOrder } from "../../model/order.ts";
import { idOf, lineage, parentOf } from "../../model/path.ts";
import { KIND_WORDS } from "../../plan/legal.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { select, selected, toggle } from "../../store/page/view.ts";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { Marked } from "../../ui/marked.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import { useHost } from "../context.tsx";
import { ElementMenu } from "../element_menu.tsx";
import { KIND_ICONS } from "../kinds.ts";
import { forTab, type TabPanelProps } from "../parts/for_tab.tsx";
import { reveal } from "../reveal.ts";
import { filtered } from "./rows.ts";
import "./tree.css";

export const StateTree = forTab(
  StateTreeOfTab,
  <Empty
    icon={<ListTree size={22} />}
    title="No machine is open"
    text="All states of the open machine appear here as a tree."
  />,
);

function StateTreeOfTab({ tab }: TabPanelProps) {
  const host = useHost();
  const { machine } = tab.session;
  const version = useSignal(tab.session.version);
  const selection = useSignal(tab.view.selection);
  const [query, setQuery] = useState("");
  const [menu, setMenu] = useState<Point | null>(null);
  const [open, expand] = useOpen(tab);
  // biome-ignore lint/correctness/useExhaustiveDependencies: the machine is a mutable object; its version changes with it
  const { shown, spans } = useMemo(() => filtered(machine, query), [machine, query, version]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: as above
  const childrenOf = useCallback(
    (path: string) => childrenIn(machine, path, shown),
    [machine, shown, version],
  );
  const paths = useMemo(() => statesIn(selection), [selection]);
  const [first] = paths;
  const roots = useMemo(() => [machine.root], [machine.root]);
  return (
    <div className="state-tree">
      <div className="state-tree-bar">
        <TextField
          label="Filter states"
          hideLabel
          type="search"
          placeholder="Filter states"
          value=""
          onInput={setQuery}
        />
      </div>
      {shown?.size === 0 ? (
        <Empty title="No state" text={`No state name or id contains “${query}”.`} />
      ) : (
        <Tree
          label="States"
          roots={roots}
          id={(path) => path}
          childrenOf={childrenOf}
          expanded={shown ?? open}
          text={(path) => inWords(machine, path)}
          row={(path) => <Row machine={machine} path={path} spans={spans.get(path) ?? []} />}
          onExpand={expand}
          selected={paths}
          onSelect={(path, how) => choose(tab, path, how.toggle)}
          onOpen={(path) => reveal(host, { kind: "state", path })}
          onHover={(path) => {
            tab.view.hovered.value = path === null ? null : { kind: "state", path };
          }}
          onMenu={(path, at) => {
            if (!paths.has(path)) choose(tab, path, false);
            setMenu(at);
          }}
          onKey={(_, event) => {
            if (event.key === "Delete") host.commands.run("edit.delete", host.context());
          }}
          reveal={first ?? null}
        />
      )}
      {menu && (
        <ElementMenu at={menu} elements={selected(tab.view)} onClose={() => setMenu(null)} />
      )}
    </div>
  );
}

/** Expanded states: those that the user expanded, and those around the selected states. */
function useOpen(tab: OpenTab): [ReadonlySet<string>, (path: string, open: boolean) => void] {
  const { openInTree } = tab.view;
  const { root } = tab.session.machine;
  const rootAlone = useMemo(() => new Set([root]), [root]);
  const open = useSignal(openInTree) ?? rootAlone;
  const change = useCallback(
    (next: (before: ReadonlySet<string>) => ReadonlySet<string>) => {
      openInTree.value = next(openInTree.peek() ?? rootAlone);
    },
    [openInTree, rootAlone],
  );
  const selection = useSignal(tab.view.selection);
  useEffect(() => {
    const around = [...statesIn(selection)].flatMap((path) => lineage(path).slice(0, -1));
    if (around.length > 0) change((before) => withAll(before, around));
  }, [selection, change]);
  const expand = (path: string, isOpen: boolean) =>
    change((before) => {
      const now = new Set(before);
      if (isOpen) now.add(path);
      else now.delete(path);
      return now;
    });
  return [open, expand];
}

function statesIn(selection: ReadonlySet<ElementKey>): ReadonlySet<string> {
  return new Set(
    [...selection].flatMap((key) => {
      const element = elementOf(key);
      return element?.kind === "state" ? [element.path] : [];
    }),
  );
}

function withAll(before: ReadonlySet<string>, more: readonly string[]): ReadonlySet<string> {
  return more.every((path) => before.has(path)) ? before : new Set([...before, ...more]);
}

function childrenIn(
  machine: Machine,
  path: string,
  shown: ReadonlySet<string> | null,
): readonly string[] | null {
  const children = inOrder(machine, path);
  const some = shown ? children.filter((child) => shown.has(child)) : children;
  return some.length === 0 ? null : some;
}

function choose(tab: OpenTab, path: string, joins: boolean): void {
  if (joins) toggle(tab.view, { kind: "state", path });
  else select(tab.view, [{ kind: "state", path }]);
}

function isStart(machine: Machine, path: string): boolean {
  const parent = parentOf(path);
  const container = parent === null ? undefined : machine.state(parent);
  const start = container && startOf(container);
  return start?.to_outcome == null && start?.to_state === idOf(path);
}

function inWords(machine: Machine, path: string): string {
  const state = machine.state(path);
  if (!state) return idOf(path);
  const start = isStart(machine, path) ? ", start" : "";
  return `${state.name}, ${KIND_WORDS[state.kind]}${start}`;
}

interface StateRowProps {
  readonly machine: Machine;
  readonly path: string;
  readonly spans: readonly TextSpan[];
}

function Row({ machine, path, spans }: StateRowProps): ReactNode {
  const state = machine.state(path);
  if (!state) return null;
  const Icon = KIND_ICONS[state.kind];
  const { library } = state;
  const what = library ? `library ${library.path}/${library.name}` : KIND_WORDS[state.kind];
  return (
    <span
      className={`state-tree-row ${machine.isInLibrary(path) ? "state-tree-foreign" : ""}`}
      title={`${state.name} · ${what} · ${idOf(path)}`}
    >
      <Icon size={14} aria-hidden />
      <span className="state-tree-name">
        <Marked text={state.name} spans={spans} />
      </span>
      {isStart(machine, path) && <span className="state-tree-start">start</span>}
      <span className="state-tree-id">{idOf(path)}</span>
    </span>
  );
}
