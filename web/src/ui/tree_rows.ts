/** Visible rows of a tree, in order, with their depth. Independent of rendering. */

export interface TreeSource<T> {
  readonly roots: readonly T[];
  readonly id: (node: T) => string;
  /** Children; null for a leaf. */
  readonly childrenOf: (node: T) => readonly T[] | null;
  readonly expanded: ReadonlySet<string>;
}

export interface TreeRow<T> {
  readonly node: T;
  readonly id: string;
  readonly depth: number;
  /** Index of the row of the node around it; -1 for roots. */
  readonly parent: number;
  /** Undefined if it cannot be opened. */
  readonly open: boolean | undefined;
  /** Its place among its siblings, from 1, and how many there are. */
  readonly place: number;
  readonly siblings: number;
}

/** All rows that show, from the top. */
export function treeRows<T>({ roots, id, childrenOf, expanded }: TreeSource<T>): TreeRow<T>[] {
  const rows: TreeRow<T>[] = [];
  const add = (nodes: readonly T[], depth: number, parent: number) => {
    nodes.forEach((node, index) => {
      const inside = childrenOf(node);
      const key = id(node);
      const open = inside === null ? undefined : expanded.has(key);
      const at = rows.length;
      rows.push({ node, id: key, depth, parent, open, place: index + 1, siblings: nodes.length });
      if (open && inside) add(inside, depth + 1, at);
    });
  };
  add(roots, 0, -1);
  return rows;
}

/** Effect of a key in a tree: another active row, or a row to open or fold. */
type TreeMove =
  | { readonly to: number }
  | { readonly expand: number; readonly open: boolean }
  | null;

/** As screen readers' users know it: arrows, Home, End, pages. */
export function treeKey<T>(
  rows: readonly TreeRow<T>[],
  at: number,
  key: string,
  page: number,
): TreeMove {
  const row = rows[at];
  const last = rows.length - 1;
  const bounded = (index: number) => ({ to: Math.max(0, Math.min(last, index)) });
  switch (key) {
    case "ArrowDown":
      return bounded(at + 1);
    case "ArrowUp":
      return bounded(at - 1);
    case "PageDown":
      return bounded(at + page);
    case "PageUp":
      return bounded(at - page);
    case "Home":
      return bounded(0);
    case "End":
      return bounded(last);
    case "ArrowRight":
      if (row?.open === false) return { expand: at, open: true };
      return row?.open ? bounded(at + 1) : null;
    case "ArrowLeft":
      if (row?.open) return { expand: at, open: false };
      return row && row.parent >= 0 ? { to: row.parent } : null;
    default:
      return null;
  }
}

/** The next row whose text begins so, from the active one on and around; -1 if there is none. */
export function treeFind<T>(
  rows: readonly TreeRow<T>[],
  at: number,
  typed: string,
  text: (node: T) => string,
): number {
  const wanted = typed.toLowerCase();
  for (let step = typed.length === 1 ? 1 : 0; step <= rows.length; step++) {
    const index = (at + step) % rows.length;
    const row = rows[index];
    if (row && text(row.node).toLowerCase().startsWith(wanted)) return index;
  }
  return -1;
}
