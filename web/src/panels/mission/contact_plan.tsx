/** Planned contacts with a robot: view and edit. Loaded on request. */

import { Plus, Trash2 } from "lucide-react";
import { useCallback, useEffect, useState } from "react";
import { lacks } from "../../commands/run_rules.ts";
import type { ContactWindow } from "../../model/generated/protocol.ts";
import { RefusalError } from "../../store/page/server.ts";
import { utcTime } from "../../store/page/times.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Select, TextField } from "../../ui/field.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { UTC_HINT, utcEntered, utcText } from "./utc_entry.ts";
import "./command_list.css";

/** Link profiles of the station. */
const PROFILES = ["lan", "wifi", "delay-2s", "deep"] as const;

interface WindowEntry {
  readonly begin: string;
  readonly end: string;
  readonly profile: (typeof PROFILES)[number];
  readonly note: string;
}

const EMPTY: WindowEntry = { begin: "", end: "", profile: "delay-2s", note: "" };

export interface ContactPlanProps {
  readonly robot: string;
  readonly now_ms: number;
  readonly onClose: () => void;
}

export function ContactPlan({ robot, now_ms, onClose }: ContactPlanProps) {
  const { page } = useHost().context();
  const { windows, change } = useContacts(robot);
  const [entry, setEntry] = useState(EMPTY);
  // Fields keep their text, so an addition replaces them with new ones.
  const [additions, setAdditions] = useState(0);
  const [fault, setFault] = useState<string | null>(null);
  const refusal = useComputed(() => lacks(page, "command"), [page]);
  if (windows === null) return <Button onClick={onClose}>Close planned contacts</Button>;
  const coming = windows.filter(({ end }) => Date.parse(end) > now_ms);
  const edit = (part: Partial<WindowEntry>) => {
    setFault(null);
    setEntry({ ...entry, ...part });
  };
  const add = async () => {
    const begin_ms = utcEntered(entry.begin);
    const end_ms = utcEntered(entry.end);
    if (begin_ms === null) return setFault(`Begin: ${UTC_HINT}`);
    if (end_ms === null) return setFault(`End: ${UTC_HINT}`);
    const note = entry.note.trim();
    const added: ContactWindow = {
      begin: utcText(begin_ms),
      end: utcText(end_ms),
      profile: entry.profile,
      ...(note !== "" && { note }),
    };
    const all = [...coming, added].sort((a, b) => Date.parse(a.begin) - Date.parse(b.begin));
    if (!(await change(windows, all))) return;
    setEntry(EMPTY);
    setAdditions(additions + 1);
  };
  return (
    <div className="command-list" role="group" aria-label={`Planned contacts with ${robot}`}>
      <p>
        <strong>Planned contacts</strong>
        {coming.length === 0 ? ": none" : ""}
      </p>
      <ol>
        {coming.map((window) => (
          <li key={window.begin}>
            <span>{windowInWords(window, now_ms)}</span>
            <IconButton
              label={refusal ?? `Remove the contact at ${window.begin}`}
              icon={<Trash2 size={16} />}
              disabled={refusal !== null}
              onClick={() =>
                void change(
                  windows,
                  coming.filter((other) => other !== window),
                )
              }
            />
          </li>
        ))}
      </ol>
      <div key={additions} className="command-list-entry" role="group" aria-label="New contact">
        <TextField
          label="Begin (UTC)"
          value={entry.begin}
          placeholder="2026-11-28 14:00:00"
          onInput={(begin) => edit({ begin })}
        />
        <TextField
          label="End (UTC)"
          value={entry.end}
          placeholder="2026-11-28 14:20:00"
          onInput={(end) => edit({ end })}
        />
        <Select
          label="Link profile"
          value={entry.profile}
          options={PROFILES.map((value) => ({ value, title: value }))}
          onChange={(profile) => edit({ profile })}
        />
        <TextField label="Note" value={entry.note} onInput={(note) => edit({ note })} />
        {fault !== null && (
          <p className="command-list-fault" role="alert">
            {fault}
          </p>
        )}
        <div className="command-list-buttons">
          <Button onClick={onClose}>Close</Button>
          <Button
            kind="primary"
            icon={<Plus size={16} aria-hidden />}
            disabled={refusal !== null}
            title={refusal ?? "Adds the contact to the plan of the station"}
            onClick={() => void add()}
          >
            Add contact
          </Button>
        </div>
      </div>
    </div>
  );
}

interface Contacts {
  /** Null until they are received. */
  readonly windows: readonly ContactWindow[] | null;
  /** Replaces the displayed plan. Returns false if it was refused, or changed by another user in the meantime. */
  readonly change: (
    displayed: readonly ContactWindow[],
    next: readonly ContactWindow[],
  ) => Promise<boolean>;
}

function useContacts(robot: string): Contacts {
  const { page } = useHost().context();
  const [windows, setWindows] = useState<readonly ContactWindow[] | null>(null);
  const path = `/robots/${encodeURIComponent(robot)}/contacts`;
  const { request } = page.server;
  const load = useCallback(() => request<readonly ContactWindow[]>("GET", path), [request, path]);
  const report = useCallback(
    (error: unknown) => {
      if (!(error instanceof RefusalError)) throw error;
      page.tell({ level: "error", text: error.message });
    },
    [page],
  );
  useEffect(() => void load().then(setWindows, report), [load, report]);
  const change: Contacts["change"] = async (displayed, next) => {
    try {
      const present = await load();
      if (JSON.stringify(present) !== JSON.stringify(displayed)) {
        setWindows(present);
        page.tell({ level: "error", text: "the plan was changed by somebody else: review it" });
        return false;
      }
      await request("PUT", path, next);
      setWindows(await load());
      return true;
    } catch (error) {
      report(error);
      return false;
    }
  };
  return { windows, change };
}

function windowInWords({ begin, end, profile, note }: ContactWindow, now_ms: number): string {
  const from = utcTime(Date.parse(begin), now_ms);
  const to = utcTime(Date.parse(end), now_ms);
  return [`${from} to ${to}`, `profile ${profile}`, ...(note ? [note] : [])].join(", ");
}
