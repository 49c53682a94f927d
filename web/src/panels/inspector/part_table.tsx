/** Table of ports or outcomes. Its rows are copied, cut, pasted and removed by keys or by its menu. */

import { ClipboardPaste } from "lucide-react";
import { type ClipboardEvent, useRef, useState } from "react";
import { copyElements, NOTHING_COPIED, read } from "../../commands/clipboard.ts";
import type { ElementRef } from "../../model/element.ts";
import type { Point } from "../../model/geometry.ts";
import { partsIn } from "../../plan/clipboard.ts";
import { type PartKind, pasteParts } from "../../plan/parts.ts";
import { removeElements } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import type { TextTransfer } from "../../store/page/command_arguments.ts";
import { IconButton } from "../../ui/button.tsx";
import { useChosenRows } from "../../ui/chosen_rows.ts";
import { ContextMenu, type MenuItem } from "../../ui/menu.tsx";
import { Table, type TableColumn } from "../../ui/table.tsx";
import type { InspectedState } from "./inspector_context.ts";

interface PartsOf {
  readonly inspected: InspectedState;
  readonly kind: PartKind;
  readonly run: (made: Made) => void;
}

interface PartTableProps<T> extends PartsOf {
  readonly label: string;
  readonly rows: readonly T[];
  readonly columns: readonly TableColumn<T>[];
  /** Id of a row that was just added by the button, to edit it at once. */
  readonly added?: number | undefined;
  /** True if rows can be added and removed. */
  readonly canChange: boolean;
}

const ROWS_MAX = 12;

interface MenuAt<T> {
  readonly at: Point;
  readonly rows: readonly T[];
}

export function PartTable<T extends { readonly id: number }>(props: PartTableProps<T>) {
  const { inspected, kind, run, label, rows, columns, canChange } = props;
  const chosen = useChosenRows(rows, idOf);
  const [menu, setMenu] = useState<MenuAt<T> | null>(null);
  const refsOf = (parts: readonly T[]) =>
    parts.map(({ id }) => ({ kind, path: inspected.path, id }));
  const remove = (parts: readonly T[]) =>
    run(inspected.edit((now) => removeElements(now, refsOf(parts))));
  const copy = (parts: readonly T[], transfer: TextTransfer | null) =>
    copyElements(inspected.machine, refsOf(parts), transfer);
  const cut = async (parts: readonly T[], transfer: TextTransfer | null) =>
    (await copy(parts, transfer)) ?? inspected.edit((now) => removeElements(now, refsOf(parts)));
  const happened = (event: ClipboardEvent) => {
    if (event.target instanceof HTMLInputElement) return;
    const parts = chosen.with();
    const isCopied = event.type !== "paste" && parts.length > 0;
    if (event.type === "copy" && isCopied) run(copy(parts, event.clipboardData));
    else if (event.type === "cut" && isCopied && canChange) run(cut(parts, event.clipboardData));
    else if (event.type === "paste" && canChange) run(pasteInto(props, event.clipboardData));
    else return;
    event.preventDefault();
  };
  const items = (parts: readonly T[]): readonly MenuItem[] => [
    { id: "copy", title: "Copy", keys: "Ctrl+C", run: () => run(copy(parts, null)) },
    {
      id: "cut",
      title: "Cut",
      keys: "Ctrl+X",
      disabled: !canChange,
      run: () => run(cut(parts, null)),
    },
    {
      id: "paste",
      title: "Paste",
      keys: "Ctrl+V",
      disabled: !canChange,
      run: () => run(pasteInto(props, null)),
    },
    "separator",
    {
      id: "delete",
      title: "Delete",
      keys: "Delete",
      disabled: !canChange,
      run: () => remove(parts),
    },
  ];
  return (
    <div onCopy={happened} onCut={happened} onPaste={happened}>
      <Table
        label={label}
        columns={columns}
        rows={rows}
        id={idOf}
        rowsMax={ROWS_MAX}
        newRow={props.added === undefined ? undefined : String(props.added)}
        selected={chosen.ids}
        onSelect={chosen.choose}
        onHover={(part) => inspected.hover(part && refOf(props, part))}
        onDelete={canChange ? (part) => remove(chosen.with(part)) : undefined}
        onMenu={(part, at) => setMenu({ at, rows: chosen.with(part) })}
      />
      {menu && (
        <ContextMenu
          label={`of ${label}`}
          at={menu.at}
          items={items(menu.rows)}
          onClose={() => setMenu(null)}
        />
      )}
    </div>
  );
}

/** Finds the row that was added by a button. Returns its id, and a function to call when the button is pressed. */
export function useAdded(
  rows: readonly { readonly id: number }[],
): readonly [number | undefined, () => void] {
  const before = useRef<ReadonlySet<number> | null>(null);
  const added = rows.find(({ id }) => before.current?.has(id) === false)?.id;
  const pressed = () => {
    before.current = new Set(rows.map(({ id }) => id));
  };
  return [added, pressed];
}

function idOf({ id }: { readonly id: number }): string {
  return String(id);
}

function refOf({ inspected, kind }: PartsOf, { id }: { readonly id: number }): ElementRef {
  return { kind, path: inspected.path, id };
}

/** Pastes the clipboard as rows of this table. */
async function pasteInto(
  { inspected, kind }: PartsOf,
  transfer: TextTransfer | null,
): Promise<string | null> {
  const clip = await read(transfer);
  if (!clip) return NOTHING_COPIED;
  return inspected.edit((now) => pasteParts(now, inspected.path, partsIn(clip), kind));
}

/** Button that pastes into an empty table. */
export function PasteButton({ words, ...parts }: PartsOf & { readonly words: string }) {
  return (
    <IconButton
      label={`Paste as ${words}`}
      icon={<ClipboardPaste size={14} />}
      onClick={() => parts.run(pasteInto(parts, null))}
    />
  );
}
