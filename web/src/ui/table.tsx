/** A table of any length: only rows in sight are made; cells are walked by keyboard and edited in place. */

import { ArrowDown, ArrowUp } from "lucide-react";
import { type KeyboardEvent, type ReactNode, useEffect, useId, useRef, useState } from "react";
import { CellEditor, type CellStep } from "./cell_editor.tsx";
import type { Commit } from "./field.tsx";
import { rowHeight } from "./rows.ts";
import { useRowsInSight } from "./rows_in_sight.ts";
import { isAtEnd, useScrolled } from "./scrolled.ts";
import "./table.css";

export interface TableColumn<T> {
  readonly key: string;
  readonly title: string;
  /** Hidden heading for screen readers. */
  readonly hideTitle?: boolean | undefined;
  /** As CSS grids write it: `120px`, `1fr`, `minmax(80px, 2fr)`; left out: `1fr`. */
  readonly width?: string | undefined;
  readonly align?: "left" | "right" | "centre" | undefined;
  readonly cell: (row: T) => ReactNode;
  /** Left out: it cannot be edited. */
  readonly edit?:
    | {
        /** The text that is edited; null where this row cannot be. */
        readonly value: (row: T) => string | null;
        /** Returns nothing on success, or the reason of a refusal. */
        readonly commit: (row: T, text: string) => Commit;
        readonly check?: ((row: T, text: string) => string | null) | undefined;
        readonly suggestions?: ((row: T) => readonly string[]) | undefined;
        readonly mono?: boolean | undefined;
      }
    | undefined;
  /** True if a click on the heading sorts by this column. */
  readonly sortable?: boolean | undefined;
}

/** Mode of a selection: Ctrl toggles a row, Shift selects a range. */
export interface RowChoice {
  readonly toggle: boolean;
  readonly extend: boolean;
}

const ALONE: RowChoice = { toggle: false, extend: false };

export interface TableProps<T> {
  /** Accessible name. */
  readonly label: string;
  readonly columns: readonly TableColumn<T>[];
  readonly rows: readonly T[];
  readonly id: (row: T) => string;
  readonly selected?: ReadonlySet<string> | undefined;
  readonly onSelect?: ((row: T, how: RowChoice) => void) | undefined;
  /** Enter on a cell that cannot be edited, or double click. */
  readonly onOpen?: ((row: T) => void) | undefined;
  readonly onDelete?: ((row: T) => void) | undefined;
  readonly onMenu?: ((row: T, at: { readonly x: number; readonly y: number }) => void) | undefined;
  readonly onHover?: ((row: T | null) => void) | undefined;
  readonly sort?: { readonly key: string; readonly down: boolean } | undefined;
  readonly onSort?: ((key: string) => void) | undefined;
  /** Maximum number of visible rows, for a table that is as tall as its rows. */
  readonly rowsMax?: number | undefined;
  readonly hideHead?: boolean | undefined;
  /** Stays at its end while rows come. */
  readonly follow?: boolean | undefined;
  /** Somebody has scrolled it: to its end, or away from there. */
  readonly onEnd?: ((isAtEnd: boolean) => void) | undefined;
  /** A row that was just added: the first of its cells that can be edited is, at once. */
  readonly newRow?: string | undefined;
  /** The id of a row that is brought into sight whenever it is another. */
  readonly inSight?: string | undefined;
  /** Appearance of a row. */
  readonly rowClass?: ((row: T) => string | undefined) | undefined;
}

/** Height of the head, equal to `.table-head` in `table.css`. */
const HEAD_PX = 26;

interface Cell {
  readonly row: string;
  readonly column: number;
}

export function Table<T>(props: TableProps<T>) {
  const { rows, columns, id, rowsMax, follow = false } = props;
  const place = useRef<HTMLDivElement>(null);
  const base = useId();
  const headRows = props.hideHead ? 0 : 1;
  const [active, setActive] = useState<Cell | null>(null);
  const [editing, setEditing] = useState(false);
  const headPx = props.hideHead ? 0 : HEAD_PX;
  const sight = useRowsInSight(place, rows.length, rowHeight(), headPx);
  const scrolled = useScrolled(place, follow, rows.length);
  const { show } = sight;
  useInSight(props, show, scrolled.note);
  const at = rows.findIndex((row) => id(row) === active?.row);
  const go = (index: number, column: number, how = ALONE) => {
    const row = rows[Math.max(0, Math.min(rows.length - 1, index))];
    if (row === undefined) return;
    setEditing(false);
    setActive({ row: id(row), column: Math.max(0, Math.min(columns.length - 1, column)) });
    show(rows.indexOf(row));
    scrolled.note();
    props.onSelect?.(row, how);
  };
  useNewRow(props, (index, column) => {
    go(index, column);
    setEditing(true);
  });
  const template = columns.map((column) => column.width ?? "minmax(0, 1fr)").join(" ");
  const cursor: Cursor = { at, column: active?.column ?? 0, editing, setEditing, go };
  const stop = (step: CellStep) => {
    const next = step === 0 ? null : nextEditable(props, cursor, step);
    if (next) go(next.index, next.column);
    else place.current?.focus();
    setEditing(next !== null);
  };
  // Rows out of sight are not rendered and have no id.
  const isShown = sight.indices.includes(at);
  const height = rowsMax && Math.min(rows.length, rowsMax) * rowHeight() + headPx;
  return (
    <div
      ref={place}
      className="table"
      role="grid"
      aria-label={props.label}
      aria-multiselectable={props.selected ? true : undefined}
      aria-rowcount={rows.length + headRows}
      aria-activedescendant={isShown && !editing ? cellId(base, at, cursor.column) : undefined}
      tabIndex={0}
      data-follow={follow}
      style={height === undefined ? undefined : { height }}
      onScroll={({ currentTarget }) => {
        if (scrolled.isSomebody()) props.onEnd?.(isAtEnd(currentTarget));
      }}
      onKeyDown={(event) => tableKey(event, props, cursor, place.current)}
      onMouseLeave={() => props.onHover?.(null)}
    >
      {!props.hideHead && <Head table={props} template={template} />}
      <div className="table-space" role="rowgroup" style={{ height: sight.height }}>
        {sight.indices.map((index) => {
          const row = rows[index];
          if (row === undefined) return null;
          return (
            <Row
              key={id(row)}
              table={props}
              row={row}
              index={index}
              template={template}
              cursor={cursor}
              base={base}
              onStop={stop}
            />
          );
        })}
      </div>
    </div>
  );
}

/** Scrolls the row of `inSight` into view whenever it is another. */
function useInSight<T>(
  props: TableProps<T>,
  show: (index: number, how?: "centre") => void,
  note: () => void,
): void {
  const latest = useRef({ props, note });
  latest.current = { props, note };
  const { inSight } = props;
  useEffect(() => {
    const { rows, id } = latest.current.props;
    const index = rows.findIndex((row) => id(row) === inSight);
    if (inSight === undefined || index < 0) return;
    show(index, "centre");
    latest.current.note();
  }, [inSight, show]);
}

/** Begins to edit the first cell of a row that was just added. */
function useNewRow<T>(props: TableProps<T>, edit: (index: number, column: number) => void): void {
  const latest = useRef({ props, edit });
  latest.current = { props, edit };
  const { newRow } = props;
  useEffect(() => {
    const { rows, columns, id } = latest.current.props;
    const index = rows.findIndex((row) => id(row) === newRow);
    const row = rows[index];
    const column = columns.findIndex(({ edit }) => row !== undefined && edit?.value(row) != null);
    if (newRow !== undefined && column >= 0) latest.current.edit(index, column);
  }, [newRow]);
}

interface Cursor {
  readonly at: number;
  readonly column: number;
  readonly editing: boolean;
  readonly setEditing: (editing: boolean) => void;
  readonly go: (index: number, column: number, how?: RowChoice) => void;
}

/** The cell that Tab leads to: the nearest one that can be edited, over the ends of rows. */
function nextEditable<T>(
  { rows, columns }: TableProps<T>,
  { at, column }: Cursor,
  step: CellStep,
): { readonly index: number; readonly column: number } | null {
  const count = rows.length * columns.length;
  for (let cell = at * columns.length + column + step; cell >= 0 && cell < count; cell += step) {
    const index = Math.floor(cell / columns.length);
    const row = rows[index];
    const value = row === undefined ? null : columns[cell % columns.length]?.edit?.value(row);
    if (value != null) return { index, column: cell % columns.length };
  }
  return null;
}

function tableKey<T>(
  event: KeyboardEvent<HTMLElement>,
  table: TableProps<T>,
  cursor: Cursor,
  place: HTMLElement | null,
): void {
  if (event.target !== place || event.ctrlKey || event.altKey || event.metaKey) return;
  const row = table.rows[cursor.at];
  const handled =
    walk(event, table.rows.length, cursor, place) ||
    (row !== undefined && act(event, table, row, cursor, place));
  if (!handled) return;
  event.preventDefault();
  event.stopPropagation();
}

function walk(
  { key, shiftKey }: KeyboardEvent<HTMLElement>,
  count: number,
  cursor: Cursor,
  place: HTMLElement | null,
): boolean {
  const { at, column } = cursor;
  const page = Math.max(1, Math.floor((place?.clientHeight ?? 0) / rowHeight()) - 2);
  const walks: Record<string, readonly [number, number]> = {
    ArrowDown: [at + 1, column],
    ArrowUp: [at - 1, column],
    ArrowRight: [at, column + 1],
    ArrowLeft: [at, column - 1],
    PageDown: [at + page, column],
    PageUp: [at - page, column],
    Home: [0, column],
    End: [count - 1, column],
  };
  const to = walks[key];
  if (to) cursor.go(to[0], to[1], { toggle: false, extend: shiftKey });
  return to !== undefined;
}

function act<T>(
  event: KeyboardEvent<HTMLElement>,
  table: TableProps<T>,
  row: T,
  cursor: Cursor,
  place: HTMLElement | null,
): boolean {
  const value = table.columns[cursor.column]?.edit?.value(row) ?? null;
  switch (event.key) {
    case "Enter":
    case "F2":
      if (value !== null) cursor.setEditing(true);
      else table.onOpen?.(row);
      return true;
    case "Delete":
      table.onDelete?.(row);
      return table.onDelete !== undefined;
    case "ContextMenu":
    case "F10": {
      if (!table.onMenu || (event.key === "F10" && !event.shiftKey)) return false;
      const box = place?.querySelector("[data-active=true]")?.getBoundingClientRect();
      table.onMenu(row, { x: (box?.left ?? 0) + 24, y: box?.bottom ?? 0 });
      return true;
    }
    default:
      return false;
  }
}

function Head<T>({ table, template }: { table: TableProps<T>; template: string }) {
  return (
    // biome-ignore lint/a11y/useFocusableInteractive: the grid around it has the keyboard
    <div
      className="table-head"
      role="row"
      aria-rowindex={1}
      style={{ gridTemplateColumns: template }}
    >
      {table.columns.map((column) => {
        const sorted = table.sort?.key === column.key ? table.sort : undefined;
        const Arrow = sorted?.down ? ArrowDown : ArrowUp;
        return (
          // biome-ignore lint/a11y/useFocusableInteractive: the grid around it has the keyboard
          <div
            key={column.key}
            className={cellClass(column.align)}
            role="columnheader"
            aria-sort={sorted && (sorted.down ? "descending" : "ascending")}
          >
            {column.title === "" && <span className="visually-hidden">Actions</span>}
            {column.sortable ? (
              <button
                type="button"
                className="table-sort"
                onClick={() => table.onSort?.(column.key)}
              >
                {column.title}
                {sorted && <Arrow size={12} aria-hidden />}
              </button>
            ) : (
              <span className={column.hideTitle ? "visually-hidden" : undefined}>
                {column.title}
              </span>
            )}
          </div>
        );
      })}
    </div>
  );
}

interface TableRowProps<T> {
  readonly table: TableProps<T>;
  readonly row: T;
  readonly index: number;
  readonly template: string;
  readonly cursor: Cursor;
  /** Prefix of the ids of its cells. */
  readonly base: string;
  readonly onStop: (step: CellStep) => void;
}

function cellId(base: string, row: number, column: number): string {
  return `${base}-${row}-${column}`;
}

function Row<T>({ table, row, index, template, cursor, base, onStop }: TableRowProps<T>) {
  const here = cursor.at === index;
  return (
    <div
      className={`table-row ${table.rowClass?.(row) ?? ""}`}
      role="row"
      tabIndex={-1}
      aria-rowindex={index + (table.hideHead ? 1 : 2)}
      aria-selected={table.selected?.has(table.id(row))}
      style={{
        height: rowHeight(),
        transform: `translateY(${index * rowHeight()}px)`,
        gridTemplateColumns: template,
        zIndex: here && cursor.editing ? 1 : undefined,
      }}
      onMouseEnter={() => table.onHover?.(row)}
      onContextMenu={(event) => {
        if (!table.onMenu) return;
        event.preventDefault();
        if (!table.selected?.has(table.id(row))) cursor.go(index, cursor.column);
        table.onMenu(row, { x: event.clientX, y: event.clientY });
      }}
    >
      {table.columns.map((column, at) => {
        const active = here && cursor.column === at;
        const value = column.edit?.value(row) ?? null;
        const editing = active && cursor.editing && value !== null;
        return (
          // biome-ignore lint/a11y/useKeyWithClickEvents: the grid around it has the keyboard
          <div
            key={column.key}
            id={cellId(base, index, at)}
            className={cellClass(column.align)}
            role="gridcell"
            tabIndex={-1}
            data-active={active}
            data-editing={editing}
            aria-readonly={value === null}
            onMouseDown={(event) => {
              // With Shift rows are chosen, and not the text between; a double click opens, and chooses no word.
              const isExtending = event.shiftKey && table.selected !== undefined;
              const isOpening = event.detail > 1 && table.onOpen !== undefined;
              if ((isExtending || isOpening) && !editing) event.preventDefault();
            }}
            onClick={(event) => {
              if (editing) return;
              const toggle = event.ctrlKey || event.metaKey;
              cursor.go(index, at, { toggle, extend: event.shiftKey });
              event.currentTarget.closest<HTMLElement>(".table")?.focus();
            }}
            onDoubleClick={() => {
              if (value === null) table.onOpen?.(row);
              else cursor.setEditing(true);
            }}
          >
            {editing ? (
              <CellEditor
                label={column.title}
                value={value}
                mono={column.edit?.mono}
                suggestions={column.edit?.suggestions?.(row)}
                check={(text) => column.edit?.check?.(row, text) ?? null}
                onCommit={(text) => column.edit?.commit(row, text)}
                onStop={onStop}
              />
            ) : (
              column.cell(row)
            )}
          </div>
        );
      })}
    </div>
  );
}

function cellClass(align: "left" | "right" | "centre" | undefined): string {
  return align === "right" ? "table-cell table-number" : "table-cell";
}
