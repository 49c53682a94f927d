/** A tree of any size: only rows in sight are made, and the keyboard does what trees do. */

import { ChevronRight } from "lucide-react";
import {
  type DragEvent,
  type KeyboardEvent,
  type ReactNode,
  useEffect,
  useId,
  useMemo,
  useRef,
  useState,
} from "react";
import { rowHeight } from "./rows.ts";
import { useRowsInSight } from "./rows_in_sight.ts";
import { type TreeRow, type TreeSource, treeFind, treeKey, treeRows } from "./tree_rows.ts";
import "./tree.css";

export interface TreeProps<T> extends TreeSource<T> {
  /** Accessible name. */
  readonly label: string;
  /** Text of the row: its accessible name, and the target of type-ahead. */
  readonly text: (node: T) => string;
  /** Content of the row; its text by default. */
  readonly row?: ((node: T) => ReactNode) | undefined;
  readonly onExpand: (node: T, open: boolean) => void;
  readonly selected?: ReadonlySet<string> | undefined;
  /** A row was chosen; with `toggle` it joins the others or leaves them. */
  readonly onSelect?: ((node: T, how: { readonly toggle: boolean }) => void) | undefined;
  /** Enter or double click. */
  readonly onOpen?: ((node: T) => void) | undefined;
  /** The menu key, Shift+F10 or the right button: at this place of the window. */
  readonly onMenu?: ((node: T, at: { readonly x: number; readonly y: number }) => void) | undefined;
  readonly onHover?: ((node: T | null) => void) | undefined;
  readonly draggable?: ((node: T) => boolean) | undefined;
  readonly onDragStart?: ((node: T, event: DragEvent<HTMLElement>) => void) | undefined;
  readonly onDragEnd?: (() => void) | undefined;
  /** Keys that the tree itself does not use. */
  readonly onKey?: ((node: T, event: KeyboardEvent<HTMLElement>) => void) | undefined;
  /** The row with this id is brought into sight whenever it is another one. */
  readonly reveal?: string | null | undefined;
  readonly rowHeight?: number | undefined;
}

const INDENT_PX = 14;
const TYPING_MS = 700;

export function Tree<T>(props: TreeProps<T>) {
  const { roots, id, childrenOf, expanded, reveal, rowHeight: height = rowHeight() } = props;
  const place = useRef<HTMLDivElement>(null);
  const base = useId();
  const rows = useMemo(
    () => treeRows({ roots, id, childrenOf, expanded }),
    [roots, id, childrenOf, expanded],
  );
  const [activeId, setActive] = useState<string | null>(null);
  const found = rows.findIndex((row) => row.id === activeId);
  const active = Math.max(0, found);
  const sight = useRowsInSight(place, rows.length, height);
  const { show } = sight;
  const revealed = reveal == null ? -1 : rows.findIndex((row) => row.id === reveal);
  useEffect(() => {
    if (revealed < 0 || reveal == null) return;
    setActive(reveal);
    show(revealed);
  }, [reveal, revealed, show]);
  const go = (index: number) => {
    const row = rows[index];
    if (!row) return;
    setActive(row.id);
    show(index);
    props.onSelect?.(row.node, { toggle: false });
  };
  // Rows out of sight are not rendered and have no id.
  const isShown = sight.indices.includes(active);
  const keys = useTreeKeys(props, rows, active, go, place);
  return (
    <div
      ref={place}
      className="tree"
      role="tree"
      aria-label={props.label}
      aria-multiselectable={props.onSelect ? true : undefined}
      aria-activedescendant={isShown ? `${base}-${active}` : undefined}
      tabIndex={0}
      onKeyDown={keys}
      onMouseLeave={() => props.onHover?.(null)}
    >
      <div className="tree-space" style={{ height: sight.height }}>
        {sight.indices.map((index) => {
          const row = rows[index];
          return (
            row && (
              <Row
                key={row.id}
                domId={`${base}-${index}`}
                tree={props}
                row={row}
                top={index * height}
                height={height}
                active={index === active}
                onActive={() => setActive(row.id)}
              />
            )
          );
        })}
      </div>
    </div>
  );
}

function useTreeKeys<T>(
  props: TreeProps<T>,
  rows: readonly TreeRow<T>[],
  active: number,
  go: (index: number) => void,
  place: { readonly current: HTMLElement | null },
): (event: KeyboardEvent<HTMLElement>) => void {
  const typed = useRef({ text: "", at_ms: 0 });
  const type = (event: KeyboardEvent<HTMLElement>) => {
    const again = event.timeStamp - typed.current.at_ms < TYPING_MS ? typed.current.text : "";
    typed.current = { text: again + event.key, at_ms: event.timeStamp };
    const index = treeFind(rows, active, typed.current.text, props.text);
    if (index >= 0) go(index);
    return true;
  };
  const walk = (event: KeyboardEvent<HTMLElement>, node: T) => {
    const page = Math.max(
      1,
      Math.floor((place.current?.clientHeight ?? 0) / (props.rowHeight ?? rowHeight())) - 1,
    );
    const move = treeKey(rows, active, event.key, page);
    if (move && "to" in move) go(move.to);
    else if (move) props.onExpand(node, move.open);
    return move !== null;
  };
  return (event) => {
    const row = rows[active];
    if (!row || event.target !== place.current) return;
    const plain = !event.ctrlKey && !event.altKey && !event.metaKey;
    const handled =
      act(props, row.node, event, place.current) ||
      (plain && walk(event, row.node)) ||
      (plain && event.key.length === 1 && event.key !== " " && type(event));
    if (!handled) return props.onKey?.(row.node, event);
    event.preventDefault();
    event.stopPropagation();
  };
}

/** Enter opens, space chooses, the menu key asks for the menu; false if the key is none of them. */
function act<T>(
  tree: TreeProps<T>,
  node: T,
  event: KeyboardEvent<HTMLElement>,
  place: HTMLElement | null,
): boolean {
  if (event.key === "Enter" && tree.onOpen) {
    tree.onOpen(node);
    return true;
  }
  if (event.key === " " && tree.onSelect) {
    tree.onSelect(node, { toggle: event.ctrlKey });
    return true;
  }
  if ((event.key === "F10" && event.shiftKey) || event.key === "ContextMenu") {
    const box = place?.querySelector("[data-active=true]")?.getBoundingClientRect();
    tree.onMenu?.(node, { x: (box?.left ?? 0) + 24, y: box?.bottom ?? 0 });
    return true;
  }
  return false;
}

interface TreeRowProps<T> {
  readonly tree: TreeProps<T>;
  readonly row: TreeRow<T>;
  readonly domId: string;
  readonly top: number;
  readonly height: number;
  readonly active: boolean;
  readonly onActive: () => void;
}

function Row<T>({ tree, row, domId, top, height, active, onActive }: TreeRowProps<T>) {
  const { node, depth, open } = row;
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: the tree around it has the keyboard
    <div
      id={domId}
      className="tree-row"
      role="treeitem"
      tabIndex={-1}
      aria-level={depth + 1}
      aria-posinset={row.place}
      aria-setsize={row.siblings}
      aria-expanded={open}
      aria-selected={tree.selected?.has(row.id) ?? false}
      aria-label={tree.row ? undefined : tree.text(node)}
      data-active={active}
      draggable={tree.draggable?.(node) ?? false}
      style={{ height, transform: `translateY(${top}px)`, paddingLeft: 4 + depth * INDENT_PX }}
      onMouseDown={(event) => {
        // `preventDefault` here would prevent dragging, too.
        if (!event.currentTarget.draggable) event.preventDefault();
        event.currentTarget.closest<HTMLElement>(".tree")?.focus({ preventScroll: true });
      }}
      onClick={(event) => {
        event.currentTarget.closest<HTMLElement>(".tree")?.focus({ preventScroll: true });
        onActive();
        tree.onSelect?.(node, { toggle: event.ctrlKey || event.metaKey });
        if (!tree.onSelect && open !== undefined) tree.onExpand(node, !open);
      }}
      onDoubleClick={() => tree.onOpen?.(node)}
      onContextMenu={(event) => {
        if (!tree.onMenu) return;
        event.preventDefault();
        onActive();
        tree.onMenu(node, { x: event.clientX, y: event.clientY });
      }}
      onMouseEnter={() => tree.onHover?.(node)}
      onDragStart={(event) => tree.onDragStart?.(node, event)}
      onDragEnd={() => tree.onDragEnd?.()}
    >
      {/* biome-ignore lint/a11y/noStaticElementInteractions: a shortcut of the mouse for the arrow keys */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: the tree around it has the keyboard */}
      <span
        className="tree-twist"
        onClick={(event) => {
          event.stopPropagation();
          if (open !== undefined) tree.onExpand(node, !open);
        }}
      >
        {open !== undefined && <ChevronRight size={13} aria-hidden />}
      </span>
      <span className="tree-content">{tree.row ? tree.row(node) : tree.text(node)}</span>
    </div>
  );
}
