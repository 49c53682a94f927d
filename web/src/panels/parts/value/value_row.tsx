/** A value in one line, with its content below if it is expanded. */

import { ChevronRight, Copy } from "lucide-react";
import { type ReactNode, useRef, useState } from "react";
import { numbersOf, recordsOf } from "../../../model/numbers.ts";
import { previewValue } from "../../../model/preview.ts";
import { pythonOf } from "../../../model/python_of.ts";
import { type Read, read, typeWords } from "../../../model/wire.ts";
import { Button, IconButton } from "../../../ui/button.tsx";
import { FormChoice, useForm } from "./form_choice.tsx";
import type { ValueForm } from "./kept_choice.ts";
import { LongText } from "./long_text.tsx";
import { NumbersImage, NumbersPlot, NumbersTable } from "./numbers_view.tsx";
import { RecordsTable } from "./records_table.tsx";

/** Expanded parts of a value. */
interface ValueTree {
  readonly isOpen: (valuePath: string) => boolean;
  readonly toggle: (valuePath: string) => void;
}

interface ValueRowProps {
  readonly name: string | undefined;
  readonly value: unknown;
  readonly valuePath: string;
  readonly tree: ValueTree;
  /** Buttons at the end of the line. */
  readonly actions?: ReactNode;
}

/** Maximum number of characters in a line. */
const LINE_MAX = 60;

export function ValueRow({ name, value, valuePath, tree, actions }: ValueRowProps) {
  const found = read(value);
  const isOpen = tree.isOpen(valuePath) && hasInside(found);
  const short = previewValue(value, LINE_MAX);
  const words = (
    <>
      {name !== undefined && <span className="value-name">{name}</span>}
      <Short short={short} kind={found.kind} />
    </>
  );
  return (
    <div className="value-part">
      <div className="value-row">
        {hasInside(found) ? (
          <button
            type="button"
            className="value-fold"
            aria-expanded={isOpen}
            aria-label={`${name ?? "Value"}: ${short}`}
            title={short}
            onClick={() => tree.toggle(valuePath)}
          >
            <ChevronRight size={13} aria-hidden />
            {words}
          </button>
        ) : (
          <span className="value-leaf" title={short}>
            {words}
          </span>
        )}
        <TypeOf found={found} short={short} />
        <CopyButton name={name} value={value} />
        {actions}
      </div>
      {isOpen && (
        <div className="value-inside">
          <ExpandedValue found={found} name={name} valuePath={valuePath} tree={tree} />
        </div>
      )}
    </div>
  );
}

/** Abbreviated value. It is highlighted briefly after a change. */
function Short({ short, kind }: { readonly short: string; readonly kind: Read["kind"] }) {
  const first = useRef(short);
  const wasOther = useRef(false);
  wasOther.current ||= short !== first.current;
  const look = wasOther.current ? " value-changed" : "";
  return (
    <code key={short} className={`value-short value-${kind}${look}`}>
      {short}
    </code>
  );
}

/** Type, unless the text of the value contains it. */
function TypeOf({ found, short }: { found: Read; short: string }) {
  const words = typeWords(found);
  const isRedundant = found.kind === "none" || found.kind === "error" || short.startsWith(words);
  return isRedundant ? null : (
    <span className="value-type" title={words}>
      {words}
    </span>
  );
}

function CopyButton({ name, value }: { name: string | undefined; value: unknown }) {
  return (
    <IconButton
      className="value-copy"
      label={`Copy ${name ?? "the value"} as Python`}
      icon={<Copy size={12} />}
      onClick={() => void navigator.clipboard.writeText(pythonOf(value))}
    />
  );
}

function hasInside(found: Read): boolean {
  switch (found.kind) {
    case "list":
      return found.items.length > 0;
    case "dict":
      return found.entries.length > 0;
    case "text":
      return found.text.length > LINE_MAX - 2 || found.text.includes("\n");
    case "array":
      return true;
    case "error":
      return found.message.length > LINE_MAX - found.of.length - 2;
    case "object":
      return found.shown.length > LINE_MAX;
    default:
      return false;
  }
}

interface ExpandedValueProps {
  readonly found: Read;
  readonly name: string | undefined;
  readonly valuePath: string;
  readonly tree: ValueTree;
}

function ExpandedValue({ found, name = "value", valuePath, tree }: ExpandedValueProps) {
  switch (found.kind) {
    case "text":
      return <LongText text={found.text} count={found.count} />;
    case "error":
      return <LongText text={found.message} />;
    case "object":
      return <LongText text={found.shown} />;
    case "dict":
      return (
        <Parts entries={found.entries} count={found.count} valuePath={valuePath} tree={tree} />
      );
    case "list":
    case "array":
      return <Rows found={found} name={name} valuePath={valuePath} tree={tree} />;
    default:
      return null;
  }
}

interface ValueRowsProps extends ExpandedValueProps {
  readonly found: Extract<Read, { kind: "list" | "array" }>;
  readonly name: string;
}

/** List or array, in the format chosen for its kind. */
function Rows({ found, name, valuePath, tree }: ValueRowsProps) {
  const numbers = numbersOf(found);
  const records = recordsOf(found);
  const options = formsOf(found, numbers?.shape.length ?? 0, records !== null);
  const kind = records ? "records" : `${found.kind}${numbers?.shape.length ?? ""}`;
  const form = useForm(kind, options);
  return (
    <>
      {found.kind === "array" && <ArrayFacts found={found} />}
      <FormChoice kind={kind} options={options} form={form} name={name} />
      {form === "table" && records && <RecordsTable records={records} name={name} />}
      {form === "table" && numbers && <NumbersTable numbers={numbers} name={name} />}
      {form === "plot" && numbers && <NumbersPlot numbers={numbers} name={name} />}
      {form === "image" && numbers && <NumbersImage numbers={numbers} name={name} />}
      {form === "list" && found.kind === "list" && (
        <Parts
          entries={found.items.map((item, index) => [String(index), item] as const)}
          count={found.count}
          valuePath={valuePath}
          tree={tree}
        />
      )}
    </>
  );
}

/** Available formats, the default first. */
function formsOf(
  found: ValueRowsProps["found"],
  axes: number,
  isRecords: boolean,
): readonly ValueForm[] {
  if (isRecords) return ["table", "list"];
  if (found.kind === "list") {
    if (axes === 1) return ["list", "plot"];
    return axes === 2 ? ["list", "table", "image"] : ["list"];
  }
  if (axes === 0) return [];
  if (axes === 1) return ["plot", "table"];
  return axes <= 3 ? ["table", "image"] : ["table"];
}

function ArrayFacts({ found }: { found: Extract<Read, { kind: "array" }> }) {
  const isWhole = found.steps.every((step) => step === 1);
  const size = found.shape.join(" × ");
  if (!found.items) return <LongText text={found.shown} />;
  return (
    <p className="value-fact">
      {found.of} of {found.dtype}
      {size !== "" && `, ${size}`}
      {!isWhole && `; showing one in ${found.steps.join(" × ")}`}
    </p>
  );
}

interface ValuePartsProps {
  readonly entries: readonly (readonly [string, unknown])[];
  readonly count: number;
  readonly valuePath: string;
  readonly tree: ValueTree;
}

/** Number of parts that are rendered at a time. */
const PARTS_STEP = 50;

function Parts({ entries, count, valuePath, tree }: ValuePartsProps) {
  const [shown, setShown] = useState(PARTS_STEP);
  const rest = entries.length - shown;
  return (
    <>
      {entries.slice(0, shown).map(([name, value]) => (
        <ValueRow
          key={name}
          name={name}
          value={value}
          valuePath={`${valuePath}\n${name}`}
          tree={tree}
        />
      ))}
      {rest > 0 && (
        <Button kind="quiet" onClick={() => setShown(shown + PARTS_STEP)}>
          Show {Math.min(rest, PARTS_STEP)} more of {entries.length}
        </Button>
      )}
      {rest <= 0 && count > entries.length && (
        <p className="value-fact">
          {count - entries.length} more were not kept: a run keeps 256 items of a value.
        </p>
      )}
    </>
  );
}
