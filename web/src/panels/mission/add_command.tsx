/** Form that adds a command to the list of a robot. */

import { Plus } from "lucide-react";
import { useState } from "react";
import type { LinkHealth, ListedCommand } from "../../model/generated/protocol.ts";
import { utcTime } from "../../store/page/times.ts";
import { Button } from "../../ui/button.tsx";
import { Select, TextField } from "../../ui/field.tsx";
import {
  EMPTY_ENTRY,
  ENTRY_KINDS,
  type EntryTime,
  type ListEntry,
  listedCommand,
} from "./list_entry.ts";

export interface AddCommandProps {
  /** Id of the run that gets the command. */
  readonly run: string;
  readonly robot: LinkHealth;
  /** Text of the button that opens the form. */
  readonly label: string;
  /** Reason why nothing can be added. */
  readonly refusal: string | null;
  readonly now_ms: number;
  /** Returns false if the command was refused: the form then stays open. */
  readonly onAdd: (command: ListedCommand) => Promise<boolean>;
}

export function AddCommand({ run, robot, label, refusal, now_ms, onAdd }: AddCommandProps) {
  const [entry, setEntry] = useState<ListEntry | null>(null);
  const [fault, setFault] = useState<string | null>(null);
  if (entry === null) {
    return (
      <Button
        kind="quiet"
        icon={<Plus size={16} aria-hidden />}
        disabled={refusal !== null}
        title={refusal ?? "Nothing is sent before the list is released"}
        onClick={() => setEntry(EMPTY_ENTRY)}
      >
        {label}
      </Button>
    );
  }
  const change = (part: Partial<ListEntry>) => {
    setFault(null);
    setEntry({ ...entry, ...part });
  };
  const add = async () => {
    const command = listedCommand(entry, run, robot.contact?.begin_ms);
    if ("fault" in command) return setFault(command.fault);
    if (await onAdd(command)) setEntry(null);
  };
  const contact = robot.contact && utcTime(robot.contact.begin_ms, now_ms);
  return (
    <div className="command-list-entry" role="group" aria-label="New command of the list">
      <Select
        label="Command"
        value={entry.kind}
        options={ENTRY_KINDS}
        onChange={(kind) => change({ kind })}
      />
      {entry.kind === "json" && (
        <TextField
          label="Command as JSON"
          mono
          multiline
          value={entry.json}
          placeholder='{"type": "step_mode"}'
          onInput={(json) => change({ json })}
        />
      )}
      <TimeFields
        label="Takes effect"
        none="On arrival"
        kind={entry.effect}
        contact={contact}
        text={entry.effectText}
        onKind={(effect) => change({ effect, effectText: "" })}
        onText={(effectText) => change({ effectText })}
      />
      <TimeFields
        label="Expires"
        none="After the usual lifetime"
        kind={entry.expiry}
        contact={contact}
        text={entry.expiryText}
        onKind={(expiry) => change({ expiry, expiryText: "" })}
        onText={(expiryText) => change({ expiryText })}
      />
      {fault !== null && (
        <p className="command-list-fault" role="alert">
          {fault}
        </p>
      )}
      <div className="command-list-buttons">
        <Button
          onClick={() => {
            setFault(null);
            setEntry(null);
          }}
        >
          Cancel
        </Button>
        <Button kind="primary" onClick={() => void add()}>
          Add to the list
        </Button>
      </div>
    </div>
  );
}

interface TimeFieldsProps {
  readonly label: string;
  /** Text of the option without a time. */
  readonly none: string;
  readonly kind: EntryTime;
  /** Start of the next contact as text, if one is planned. */
  readonly contact: string | undefined;
  readonly text: string;
  readonly onKind: (kind: EntryTime) => void;
  readonly onText: (text: string) => void;
}

/** Fields for a kind of time, and its value. */
function TimeFields({ label, none, kind, contact, text, onKind, onText }: TimeFieldsProps) {
  return (
    <>
      <Select
        label={label}
        value={kind}
        options={[
          { value: "none", title: none },
          { value: "utc", title: "At a time (UTC)" },
          {
            value: "contact",
            title: contact ? `After the contact begins at ${contact}` : "After a planned contact",
            disabled: contact === undefined,
          },
        ]}
        onChange={onKind}
      />
      {kind !== "none" && (
        <TextField
          key={kind}
          label={kind === "utc" ? `${label} at (UTC)` : `${label}, seconds after the begin`}
          value={text}
          placeholder={kind === "utc" ? "2026-11-28 14:10:00" : "30"}
          onInput={onText}
        />
      )}
    </>
  );
}
