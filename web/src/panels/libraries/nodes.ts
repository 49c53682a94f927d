/** Library roots, folders and libraries as nodes of a tree, with a filter. */

import type { LibraryName, LibraryNode, LibraryRoot } from "../../model/generated/protocol.ts";
import { match, queryOf, type TextSpan } from "../../model/match.ts";

export interface LibraryTreeNode {
  /** Names of the root and the folders down to the node, joined by `/`. */
  readonly key: string;
  readonly name: string;
  /** Null for a library. */
  readonly children: readonly LibraryTreeNode[] | null;
  /** Name of a library as in library states; null for other nodes. */
  readonly library: LibraryName | null;
  /** Folder of a root; null for other nodes. */
  readonly folder: string | null;
  /** Parts of the name that match the filter. */
  readonly spans: readonly TextSpan[];
}

export function nodesOf(roots: readonly LibraryRoot[]): readonly LibraryTreeNode[] {
  return roots.map(({ name, folder, children }) => ({
    key: name,
    name,
    folder,
    library: null,
    spans: [],
    children: children.map((child) => nodeOf(name, child)),
  }));
}

function nodeOf(path: string, { name, kind, children }: LibraryNode): LibraryTreeNode {
  const key = `${path}/${name}`;
  const isLibrary = kind === "library";
  return {
    key,
    name,
    folder: null,
    library: isLibrary ? { path, name } : null,
    spans: [],
    children: isLibrary ? null : (children ?? []).map((child) => nodeOf(key, child)),
  };
}

/** Nodes that match, with everything inside them, and the folders around them. */
export function matching(
  nodes: readonly LibraryTreeNode[],
  text: string,
): readonly LibraryTreeNode[] {
  const query = queryOf(text);
  if (query.words.length === 0) return nodes;
  return nodes.flatMap((node): LibraryTreeNode[] => {
    const found = match(query, node.name) ?? (match(query, node.key) ? { spans: [] } : null);
    if (found && node.folder === null) return [{ ...node, spans: found.spans }];
    const children = matching(node.children ?? [], text);
    return children.length > 0 ? [{ ...node, children }] : [];
  });
}

/** Keys of all nodes that can be expanded. */
export function foldersIn(nodes: readonly LibraryTreeNode[]): ReadonlySet<string> {
  const keys = new Set<string>();
  const add = ({ key, children }: LibraryTreeNode) => {
    if (!children) return;
    keys.add(key);
    for (const child of children) add(child);
  };
  for (const node of nodes) add(node);
  return keys;
}
