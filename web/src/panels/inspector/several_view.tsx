/** Inspector of several elements: their common properties, and actions for all of them. */

import type { CommandContext, UserCommand } from "../../commands/command.ts";
import { type ElementRef, keyOf } from "../../model/element.ts";
import { nameOf } from "../../model/ends.ts";
import { readLayout } from "../../model/layout_reader.ts";
import { setBackground } from "../../plan/move.ts";
import { isRefused, type Planned, refused, together } from "../../plan/plan.ts";
import { Button } from "../../ui/button.tsx";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { useHost } from "../context.tsx";
import { type Bytes, Colour } from "./colour.tsx";
import { Fold } from "./fold.tsx";
import type { InspectorContext } from "./inspector_context.ts";
import { counted, ELEMENT_WORDS } from "./kinds.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

interface SeveralViewProps {
  readonly context: InspectorContext;
  readonly elements: readonly ElementRef[];
  /** True if the elements are the selection, which commands act on. */
  readonly isSelected: boolean;
}

export function SeveralView({ context, elements, isSelected }: SeveralViewProps) {
  const paths = elements.flatMap((each) => (each.kind === "state" ? [each.path] : []));
  const editable = paths.filter((path) => !context.machine.isInLibrary(path));
  return (
    <>
      <Fold title="Selected" count={elements.length}>
        <Chosen context={context} elements={elements} />
      </Fold>
      {isSelected && <Actions />}
      {editable.length > 0 && <Background context={context} paths={editable} />}
    </>
  );
}

const ROWS_MAX = 10;

function Chosen({
  context,
  elements,
}: {
  context: InspectorContext;
  elements: readonly ElementRef[];
}) {
  const counts = new Map<string, number>();
  for (const { kind } of elements)
    counts.set(ELEMENT_WORDS[kind], (counts.get(ELEMENT_WORDS[kind]) ?? 0) + 1);
  const columns: readonly TableColumn<ElementRef>[] = [
    { key: "name", title: "Name", cell: (element) => nameOf(context.machine, element) },
    {
      key: "kind",
      title: "Kind",
      width: "110px",
      cell: ({ kind }) => <span className="inspector-faint">{ELEMENT_WORDS[kind]}</span>,
    },
  ];
  return (
    <>
      <p className="inspector-none">
        {[...counts].map(([word, count]) => counted(count, word)).join(", ")}
      </p>
      <Table
        label="Selected elements"
        columns={columns}
        rows={elements}
        id={keyOf}
        rowsMax={ROWS_MAX}
        hideHead
        onHover={context.hover}
        onOpen={context.show}
      />
    </>
  );
}

/** Commands of the menus Edit and Arrange that are available for several elements. */
function Actions() {
  const { commands, context } = useHost();
  const now = context();
  const offered = commands.all().filter((command) => isOffered(command, now));
  return (
    <Fold title="All selected">
      <div className="inspector-buttons">
        {offered.map((command) => (
          <Button
            key={command.id}
            title={command.detail ?? command.title}
            keys={command.keys?.[0]}
            onClick={() => void commands.choose(command, context())}
          >
            {command.title}
          </Button>
        ))}
      </div>
    </Fold>
  );
}

function isOffered({ id, menu, choices, enabled }: UserCommand, now: CommandContext): boolean {
  const isFitting = menu?.startsWith("Arrange/") === true || id === "edit.delete";
  return isFitting && !choices && enabled?.(now) !== false;
}

function Background({ context, paths }: { context: InspectorContext; paths: readonly string[] }) {
  const [refusal, run] = useRefusal();
  const colours = new Set(
    paths.map((path) => {
      const state = context.machine.state(path);
      return state ? (readLayout(state).background ?? null) : null;
    }),
  );
  const [only = null] = colours;
  const paint = (colour: Bytes | null) =>
    context.edit((now): Planned => {
      const planned = paths.map((path) => setBackground(now, path, colour));
      const bad = planned.find(isRefused);
      if (bad) return refused(bad.refused);
      const edits = planned.flatMap((each) => (isRefused(each) ? [] : [each.edit]));
      return { name: `Colour ${counted(paths.length, "state")}`, edit: together(edits) };
    });
  return (
    <Fold title="Appearance">
      <Colour
        label={colours.size > 1 ? "Background colour (mixed)" : "Background colour"}
        value={colours.size > 1 ? null : only}
        onChange={(colour) => run(paint(colour))}
      />
      <Refusal text={refusal} />
    </Fold>
  );
}
