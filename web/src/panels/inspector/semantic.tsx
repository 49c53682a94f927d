/** Semantic data of a state: a tree of keys that is edited in place, or as JSON. */

import { Braces, ChevronDown, ChevronRight, FolderPlus, Plus, Trash2 } from "lucide-react";
import { useState } from "react";
import type { JsonValue } from "../../model/generated/protocol.ts";
import {
  rowKey,
  type SemanticRow,
  semanticRows,
  valueOfText,
  withKey,
  withNewKey,
  withoutKey,
  withValue,
} from "../../model/semantic.ts";
import { refused } from "../../plan/plan.ts";
import { setSemanticData } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { IconButton } from "../../ui/button.tsx";
import { TextField } from "../../ui/field.tsx";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

const ROWS_MAX = 16;

import { ROW_BUTTONS_WIDTH } from "./row_buttons.tsx";

export function Semantic({ inspected }: { inspected: InspectedState }) {
  const { state, readOnly } = inspected;
  const [asText, setAsText] = useState(false);
  const [folded, setFolded] = useState<ReadonlySet<string>>(new Set());
  const [refusal, run] = useRefusal();
  const data = state.semantic_data;
  const rows = semanticRows(data, folded);
  const put = (next: JsonValue) => putData(inspected, next);
  const add = (value: JsonValue) => run(put(withNewKey(data, [], value).data));
  const buttons = (
    <>
      <IconButton
        label="Show as JSON"
        icon={<Braces size={14} />}
        pressed={asText}
        onClick={() => setAsText(!asText)}
      />
      {!readOnly && (
        <>
          <IconButton
            label="Add group of keys"
            icon={<FolderPlus size={14} />}
            onClick={() => add({})}
          />
          <IconButton
            label="Add key with value"
            icon={<Plus size={15} />}
            onClick={() => add("")}
          />
        </>
      )}
    </>
  );
  return (
    <Fold title="Semantic data" count={rows.length} openAtFirst={rows.length > 0} actions={buttons}>
      {asText ? (
        <AsText inspected={inspected} />
      ) : rows.length === 0 ? (
        <p className="inspector-none">No semantic data (notes for planners, tools and people).</p>
      ) : (
        <Table
          label={`Semantic data of ${state.name}`}
          columns={columnsOf(inspected, folded, setFolded, run)}
          rows={rows}
          id={({ keys }) => rowKey(keys)}
          rowsMax={ROWS_MAX}
          onDelete={readOnly ? undefined : ({ keys }) => run(put(withoutKey(data, keys)))}
          onOpen={({ keys }) => setFolded(toggled(folded, rowKey(keys)))}
        />
      )}
      <Refusal text={refusal} />
    </Fold>
  );
}

function putData({ path, edit }: InspectedState, data: JsonValue): Made {
  return edit((now) => setSemanticData(now, path, data));
}

function toggled(set: ReadonlySet<string>, key: string): ReadonlySet<string> {
  const next = new Set(set);
  if (!next.delete(key)) next.add(key);
  return next;
}

function columnsOf(
  inspected: InspectedState,
  folded: ReadonlySet<string>,
  setFolded: (folded: ReadonlySet<string>) => void,
  run: (made: Made) => void,
): readonly TableColumn<SemanticRow>[] {
  const { path, state, readOnly, edit } = inspected;
  const data = state.semantic_data;
  const put = (next: JsonValue) => putData(inspected, next);
  const rename = ({ keys }: SemanticRow, name: string) =>
    edit((now) => {
      const next = withKey(data, keys, name);
      return "refused" in next ? refused(next.refused) : setSemanticData(now, path, next.data);
    });
  const fold = ({ keys }: SemanticRow) => setFolded(toggled(folded, rowKey(keys)));
  return [
    {
      key: "key",
      title: "Key",
      cell: (row) => (
        <Key row={row} isFolded={folded.has(rowKey(row.keys))} onFold={() => fold(row)} />
      ),
      edit: {
        value: ({ keys }) => (readOnly ? null : (keys.at(-1) ?? "")),
        commit: rename,
      },
    },
    {
      key: "value",
      title: "Value",
      cell: ({ text, size }) =>
        text === null ? (
          <span className="inspector-faint">{size === 1 ? "1 key" : `${size} keys`}</span>
        ) : (
          <span title={text}>{text}</span>
        ),
      edit: {
        value: ({ text }) => (readOnly ? null : text),
        commit: ({ keys }, text) => put(withValue(data, keys, valueOfText(text))),
      },
    },
    {
      key: "buttons",
      title: "Actions",
      hideTitle: true,
      width: ROW_BUTTONS_WIDTH,
      cell: (row) =>
        readOnly ? null : (
          <Buttons
            row={row}
            onAdd={() => run(put(withNewKey(data, row.keys, "").data))}
            onRemove={() => run(put(withoutKey(data, row.keys)))}
          />
        ),
    },
  ];
}

interface KeyProps {
  readonly row: SemanticRow;
  readonly isFolded: boolean;
  readonly onFold: () => void;
}

const INDENT_PX = 12;

function Key({ row: { keys, text, size }, isFolded, onFold }: KeyProps) {
  const name = keys.at(-1) ?? "";
  const Arrow = isFolded ? ChevronRight : ChevronDown;
  return (
    <span className="inspector-key" style={{ paddingLeft: (keys.length - 1) * INDENT_PX }}>
      {text === null && size > 0 ? (
        <IconButton
          className="inspector-mini"
          label={isFolded ? `Open ${name}` : `Fold ${name}`}
          icon={<Arrow size={13} />}
          onClick={onFold}
        />
      ) : (
        <span className="inspector-twist" />
      )}
      <span title={name}>{name}</span>
    </span>
  );
}

interface ButtonsProps {
  readonly row: SemanticRow;
  readonly onAdd: () => void;
  readonly onRemove: () => void;
}

function Buttons({ row: { keys, text }, onAdd, onRemove }: ButtonsProps) {
  const name = keys.at(-1) ?? "";
  return (
    <span className="inspector-row-buttons">
      {text === null && (
        <IconButton
          className="inspector-mini"
          label={`Add key inside ${name}`}
          icon={<Plus size={13} />}
          onClick={onAdd}
        />
      )}
      <IconButton
        className="inspector-mini"
        label={`Remove ${name}`}
        icon={<Trash2 size={13} />}
        onClick={onRemove}
      />
    </span>
  );
}

function AsText({ inspected }: { inspected: InspectedState }) {
  const { path, state, readOnly, edit } = inspected;
  const commit = (text: string) =>
    edit((now) => {
      const data = parsed(text);
      return data === undefined
        ? refused("This is not valid JSON.")
        : setSemanticData(now, path, data);
    });
  return (
    <TextField
      key={path}
      label="Semantic data as JSON"
      multiline
      mono
      readOnly={readOnly}
      value={JSON.stringify(state.semantic_data ?? {}, null, 2)}
      check={(text) => (parsed(text) === undefined ? reasonOf(text) : null)}
      hint="Ctrl+Enter or leaving the field applies it."
      onCommit={commit}
    />
  );
}

function parsed(text: string): JsonValue | undefined {
  try {
    return JSON.parse(text) as JsonValue;
  } catch {
    return undefined;
  }
}

function reasonOf(text: string): string {
  try {
    JSON.parse(text);
    return "";
  } catch (error) {
    return `This is not valid JSON: ${error instanceof Error ? error.message : String(error)}`;
  }
}
