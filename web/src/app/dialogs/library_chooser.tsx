/** Which library is to be used. */

import { Folder, Library } from "lucide-react";
import { useMemo, useState } from "react";
import type { LibraryNode } from "../../model/generated/protocol.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";
import { keysAboveTree } from "./tree_below.ts";

interface ChooserNode {
  readonly path: string;
  readonly name: string;
  readonly children: readonly ChooserNode[] | null;
}

function nodeOf(path: string, { name, kind, children }: LibraryNode): ChooserNode {
  const inside = `${path}/${name}`;
  const nodes = (children ?? []).map((child) => nodeOf(inside, child));
  return { path, name, children: kind === "library" ? null : nodes };
}

const keyOf = (node: ChooserNode) => `${node.path}/${node.name}`;
const childrenOf = (node: ChooserNode) => node.children;
const nameOf = (node: ChooserNode) => node.name;

function matching(nodes: readonly ChooserNode[], search: string): readonly ChooserNode[] {
  if (search === "") return nodes;
  return nodes.flatMap((node) => {
    if (node.name.toLowerCase().includes(search)) return [node];
    const children = matching(node.children ?? [], search);
    return children.length > 0 ? [{ ...node, children }] : [];
  });
}

function firstLibrary(nodes: readonly ChooserNode[]): ChooserNode | null {
  for (const node of nodes) {
    const found = node.children === null ? node : firstLibrary(node.children);
    if (found) return found;
  }
  return null;
}

/** Expanded folders: roots, and all during a search, except those that the user has toggled. */
function useExpanded(roots: readonly ChooserNode[], isSearching: boolean) {
  const [toggled, setToggled] = useState<ReadonlySet<string>>(new Set());
  const expanded = useMemo(() => {
    const open = new Set<string>();
    const add = (node: ChooserNode, depth: number) => {
      const isOpen = depth === 0 || isSearching;
      if (isOpen !== toggled.has(keyOf(node))) open.add(keyOf(node));
      for (const child of node.children ?? []) add(child, depth + 1);
    };
    for (const root of roots) add(root, 0);
    return open;
  }, [roots, isSearching, toggled]);
  const toggle = (node: ChooserNode) =>
    setToggled((before) => {
      const next = new Set(before);
      if (!next.delete(keyOf(node))) next.add(keyOf(node));
      return next;
    });
  return { expanded, toggle };
}

function LibraryRow({ node }: { readonly node: ChooserNode }) {
  return (
    <>
      {node.children === null ? (
        <Library size={14} className="tree-icon tree-icon-machine" aria-hidden />
      ) : (
        <Folder size={14} className="tree-icon" aria-hidden />
      )}
      {node.name}
    </>
  );
}

export function LibraryChooser({ asks, answer }: NamedDialogProps<"library">) {
  const { page } = useSession();
  const roots = useSignal(page.libraries);
  const [search, setSearch] = useState("");
  const [chosen, setChosen] = useState<ChooserNode | null>(null);
  const nodes = useMemo(
    () =>
      roots.map(({ name, children }) => ({
        path: "",
        name,
        children: children.map((child) => nodeOf(name, child)),
      })),
    [roots],
  );
  const shown = useMemo(() => matching(nodes, search.trim().toLowerCase()), [nodes, search]);
  const { expanded, toggle } = useExpanded(shown, search.trim() !== "");
  const first = search.trim() === "" ? null : firstLibrary(shown);
  const wanted = chosen ?? first;
  const take = (node: ChooserNode | null) => {
    if (node?.children === null) answer({ path: node.path, name: node.name });
  };
  return (
    <Dialog
      title={asks.title}
      width={560}
      height={560}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={wanted?.children !== null} onClick={() => take(wanted)}>
            {asks.yes}
          </Button>
        </>
      }
    >
      <div className="form">
        <TextField
          label="Find a library"
          hideLabel
          type="search"
          placeholder="Find a library"
          value={search}
          onInput={(text) => {
            setSearch(text);
            setChosen(null);
          }}
          autoFocus
          onKeyDown={(event) => keysAboveTree(event, () => take(wanted))}
        />
        <div className="form-tree">
          {shown.length === 0 ? (
            <Empty
              title={search === "" ? "No libraries" : "Nothing found"}
              text={
                search === ""
                  ? "Libraries come from the server's library roots."
                  : `No library name contains “${search}”.`
              }
            />
          ) : (
            <Tree
              label="Libraries"
              roots={shown}
              id={keyOf}
              childrenOf={childrenOf}
              text={nameOf}
              expanded={expanded}
              selected={new Set(wanted ? [keyOf(wanted)] : [])}
              reveal={first ? keyOf(first) : null}
              onExpand={toggle}
              onSelect={setChosen}
              onOpen={take}
              row={(node) => <LibraryRow node={node} />}
            />
          )}
        </div>
      </div>
    </Dialog>
  );
}
