/** Table of the ports that a value passes. Each can be shown on the canvas. */

import { keyOf } from "../../model/element.ts";
import { type Hop, nameOf } from "../../model/ends.ts";
import { namesTo } from "../../model/machine.ts";
import { Table, type TableColumn } from "../../ui/table.tsx";
import { Fold } from "./fold.tsx";
import type { InspectorContext } from "./inspector_context.ts";
import { PORT_TITLES } from "./ports.tsx";

interface ChainTableProps {
  readonly context: InspectorContext;
  readonly title: string;
  readonly hops: readonly Hop[];
  /** Text for an empty table. */
  readonly none?: string | undefined;
}

const ROWS_MAX = 12;

export function ChainTable({ context, title, hops, none }: ChainTableProps) {
  const { machine, show, hover } = context;
  const columns: readonly TableColumn<Hop>[] = [
    {
      key: "port",
      title: "Port",
      cell: ({ port, steps }) => {
        const names = namesTo(machine, port.path);
        return (
          <span
            title={`${names.join(" / ")}.${nameOf(machine, port)}`}
            style={{ paddingLeft: Math.max(0, steps - 1) * 10 }}
          >
            {names.at(-1)}.{nameOf(machine, port)}
          </span>
        );
      },
    },
    {
      key: "kind",
      title: "Kind",
      width: "118px",
      cell: ({ port }) => <span className="inspector-faint">{PORT_TITLES[port.kind].one}</span>,
    },
  ];
  return (
    <Fold title={title} count={hops.length}>
      {hops.length === 0 ? (
        <p className="inspector-none">{none}</p>
      ) : (
        <Table
          label={title}
          columns={columns}
          rows={hops}
          id={({ port }) => keyOf(port)}
          rowsMax={ROWS_MAX}
          hideHead
          onSelect={({ port }) => hover(port)}
          onOpen={({ port }) => show(port)}
          onHover={(hop) => hover(hop?.port ?? null)}
        />
      )}
    </Fold>
  );
}
