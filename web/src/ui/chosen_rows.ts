/** Which rows of a table are chosen: one, some with Ctrl, or all between two with Shift. */

import { useState } from "react";
import type { RowChoice } from "./table.tsx";

interface ChosenRows<T> {
  readonly ids: ReadonlySet<string>;
  readonly choose: (row: T, how: RowChoice) => void;
  /** The chosen rows in their order; of a row that is not among them only that one. */
  readonly with: (row?: T) => readonly T[];
}

interface RowSelection {
  readonly ids: ReadonlySet<string>;
  /** Start of a selection with Shift. */
  readonly anchor: string | null;
}

const NONE: RowSelection = { ids: new Set(), anchor: null };

export function useChosenRows<T>(rows: readonly T[], id: (row: T) => string): ChosenRows<T> {
  const [{ ids, anchor }, setChosen] = useState(NONE);
  return {
    ids,
    choose: (row, how) => setChosen(chosen({ ids, anchor }, rows.map(id), id(row), how)),
    with: (row) =>
      row !== undefined && !ids.has(id(row)) ? [row] : rows.filter((each) => ids.has(id(each))),
  };
}

/** The selection after a row was chosen. */
export function chosen(
  { ids, anchor }: RowSelection,
  rows: readonly string[],
  row: string,
  { toggle, extend }: RowChoice,
): RowSelection {
  const start = anchor === null ? -1 : rows.indexOf(anchor);
  if (extend && start >= 0) {
    const end = rows.indexOf(row);
    const between = rows.slice(Math.min(start, end), Math.max(start, end) + 1);
    return { ids: new Set(toggle ? [...ids, ...between] : between), anchor };
  }
  if (!toggle) return { ids: new Set([row]), anchor: row };
  const left = new Set(ids);
  if (!left.delete(row)) left.add(row);
  return { ids: left, anchor: row };
}
