/** Everything that the page and the server said, the newest at the end. */

import { Eraser } from "lucide-react";
import { useMemo, useState } from "react";
import type { LogLevel } from "../../model/generated/protocol.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { Checkbox, Select, TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { type Column, Table } from "../../ui/table.tsx";
import { useCommand, useHost } from "../context.tsx";
import { moment } from "../moment.ts";
import { reveal } from "../reveal.ts";
import { type Entry, entryOf, filtered } from "./entries.ts";
import "./log.css";

const LEAST = [
  { value: "info", title: "All" },
  { value: "warning", title: "Warnings and errors" },
  { value: "error", title: "Errors" },
] as const;

export function Log() {
  const host = useHost();
  const { page } = host.context();
  const notices = useSignal(page.notices);
  const [least, setLeast] = useState<LogLevel>("info");
  const [query, setQuery] = useState("");
  const [follows, setFollows] = useState(true);
  const [chosen, setChosen] = useState<string | null>(null);
  const entries = useMemo(() => notices.map(entryOf), [notices]);
  const rows = useMemo(() => filtered(entries, least, query), [entries, least, query]);
  if (notices.length === 0) {
    return (
      <Empty
        title="Nothing was said yet"
        text="Refused edits, saves, breaks of the connection and what others did stand here."
      />
    );
  }
  const choose = (entry: Entry) => {
    setChosen(entry.id);
    const { about } = entry;
    if (about && page.active.peek()?.room.id === about.machine) reveal(host, about.element);
  };
  const entry = rows.find(({ id }) => id === chosen);
  return (
    <div className="log">
      <div className="log-bar">
        <TextField
          label="Filter the log"
          hideLabel
          type="search"
          placeholder="Filter"
          value=""
          onInput={setQuery}
        />
        <Select label="Level" hideLabel value={least} options={LEAST} onChange={setLeast} />
        <Checkbox label="Follow" checked={follows} onChange={setFollows} />
        <span className="log-gap" />
        <IconButton
          label="Clear the log"
          icon={<Eraser size={15} />}
          onClick={() => {
            page.notices.value = [];
          }}
        />
      </div>
      <div className="log-rows">
        <Table
          label="Log"
          columns={COLUMNS}
          rows={rows}
          id={({ id }) => id}
          selected={new Set(chosen === null ? [] : [chosen])}
          onSelect={choose}
          follow={follows}
          hideHead
        />
      </div>
      {entry && <Full entry={entry} />}
    </div>
  );
}

function Full({ entry: { text, action } }: { readonly entry: Entry }) {
  const run = useCommand();
  return (
    <section className="log-full" aria-label="The chosen line">
      <p>{text}</p>
      {action && (
        <Button onClick={() => run(action.command, action.argument)}>{action.title}</Button>
      )}
    </section>
  );
}

const COLUMNS: readonly Column<Entry>[] = [
  {
    key: "time",
    title: "When",
    width: "110px",
    align: "right",
    cell: ({ at_ms }) => <span className="log-time">{moment(at_ms, Date.now())}</span>,
  },
  {
    key: "level",
    title: "Level",
    width: "70px",
    cell: ({ level }) => <span className={`log-${level}`}>{level}</span>,
  },
  {
    key: "text",
    title: "Text",
    width: "minmax(0, 1fr)",
    cell: ({ text }) => <span title={text}>{text}</span>,
  },
];
