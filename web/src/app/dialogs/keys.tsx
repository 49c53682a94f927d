/** All keys: found by what they do, changed by pressing others, checked for conflicts, taken along as a file. */

import { Plus, RotateCcw, X } from "lucide-react";
import { useMemo, useState } from "react";
import type { UserCommand } from "../../commands/command.ts";
import {
  conflicts,
  isKeptByBrowser,
  keymap,
  keyName,
  readKeys,
  shownKey,
} from "../../commands/keys.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { Select, TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

export function Keys({ answer }: NamedDialogProps<"keys">) {
  const { page, commands } = useSession();
  const settings = useSignal(page.settings);
  const [search, setSearch] = useState("");
  const all = commands.all();
  const map = useMemo(() => keymap(all, settings), [all, settings]);
  const doubled = useMemo(() => conflicts(map), [map]);
  const set = (keys: Readonly<Record<string, readonly string[]>>) => {
    page.settings.value = { ...page.settings.peek(), keys };
  };
  const groups = grouped(all, search, map);
  return (
    <Dialog title="Keys" width={680} height={640} onClose={() => answer(null)} footer={<Files />}>
      <div className="form">
        <div className="form-row">
          <TextField
            label="Find"
            type="search"
            placeholder="Command or key"
            value={search}
            onInput={setSearch}
            autoFocus
          />
          <Select
            label="Key map"
            value={settings.keymap}
            options={[
              { value: "rafcon", title: "RAFCON" },
              { value: "classic", title: "RAFCON classic" },
            ]}
            onChange={(next) => {
              page.settings.value = { ...page.settings.peek(), keymap: next };
            }}
          />
        </div>
        <div className="keys-list">
          {groups.map(([title, list]) => (
            <section key={title} aria-label={title}>
              <h3 className="keys-group">{title}</h3>
              {list.map((command) => (
                <KeysRow
                  key={command.id}
                  command={command}
                  keys={map.get(command.id) ?? []}
                  isOwn={command.id in settings.keys}
                  doubled={doubled}
                  onSet={(keys) => set({ ...settings.keys, [command.id]: keys })}
                  onReset={() =>
                    set(
                      Object.fromEntries(
                        Object.entries(settings.keys).filter(([id]) => id !== command.id),
                      ),
                    )
                  }
                />
              ))}
            </section>
          ))}
        </div>
      </div>
    </Dialog>
  );
}

function grouped(
  all: readonly UserCommand[],
  search: string,
  map: ReadonlyMap<string, readonly string[]>,
): readonly (readonly [string, readonly UserCommand[]])[] {
  const wanted = search.trim().toLowerCase();
  const groups = new Map<string, UserCommand[]>();
  for (const command of all) {
    const keys = (map.get(command.id) ?? []).map(shownKey).join(" ").toLowerCase();
    if (!command.title.toLowerCase().includes(wanted) && !keys.includes(wanted)) continue;
    const title = command.menu?.split("/")[0] ?? "Other";
    groups.set(title, [...(groups.get(title) ?? []), command]);
  }
  return [...groups];
}

interface KeysRowProps {
  readonly command: UserCommand;
  readonly keys: readonly string[];
  readonly isOwn: boolean;
  readonly doubled: ReadonlyMap<string, readonly string[]>;
  readonly onSet: (keys: readonly string[]) => void;
  readonly onReset: () => void;
}

function KeysRow({ command, keys, isOwn, doubled, onSet, onReset }: KeysRowProps) {
  const note = noteOn(keys, doubled, command.id);
  return (
    <div className="keys-row">
      <span className="keys-title">
        {command.title} {note && <span className="keys-note">{note}</span>}
      </span>
      {keys.map((key) => (
        <kbd key={key} className="key">
          {shownKey(key)}
          <button
            type="button"
            aria-label={`Remove ${shownKey(key)} from ${command.title}`}
            onClick={() => onSet(keys.filter((other) => other !== key))}
          >
            <X size={11} aria-hidden />
          </button>
        </kbd>
      ))}
      <CatchKey title={command.title} onKey={(key) => onSet([...new Set([...keys, key])])} />
      {isOwn && (
        <IconButton
          label={`Reset the keys of ${command.title}`}
          icon={<RotateCcw size={13} />}
          onClick={onReset}
        />
      )}
    </div>
  );
}

/** Notes on the keys: conflicts with another command or the browser. */
function noteOn(
  keys: readonly string[],
  doubled: ReadonlyMap<string, readonly string[]>,
  id: string,
): string | null {
  const kept = keys.find(isKeptByBrowser);
  if (kept !== undefined)
    return `the browser reserves ${shownKey(kept)} except in a separate window`;
  const others = keys.flatMap((key) => doubled.get(key) ?? []).filter((other) => other !== id);
  return others.length > 0 ? `also ${[...new Set(others)].join(", ")}` : null;
}

function CatchKey({ title, onKey }: { title: string; onKey: (key: string) => void }) {
  const [waits, setWaits] = useState(false);
  return (
    <button
      type="button"
      className="keys-catch"
      aria-pressed={waits}
      aria-label={waits ? `Press keys for ${title}` : `Add keys to ${title}`}
      onClick={() => setWaits(true)}
      onBlur={() => setWaits(false)}
      onKeyDown={(event) => {
        if (!waits || event.key === "Tab") return;
        event.preventDefault();
        event.stopPropagation();
        const key = keyName(event.nativeEvent);
        if (key === null) return;
        setWaits(false);
        if (key !== "Escape") onKey(key);
      }}
    >
      {waits ? "press keys…" : <Plus size={12} aria-hidden />}
    </button>
  );
}

/** Keys as a file: all that differ from the map. */
function Files() {
  const { page, commands } = useSession();
  const take = async (file: File | undefined) => {
    if (!file) return;
    try {
      const { keys, faults } = readKeys(await file.text(), (id) => commands.find(id) !== undefined);
      page.settings.value = { ...page.settings.peek(), keys };
      const count = Object.keys(keys).length;
      const also = faults.length > 0 ? ` Skipped: ${faults.join("; ")}.` : "";
      page.tell({
        level: faults.length > 0 ? "warning" : "info",
        text: `Imported the keys of ${count} commands.${also}`,
      });
    } catch (error) {
      page.tell({ level: "error", text: `${file.name} is not a key map file: ${String(error)}` });
    }
  };
  const give = () => {
    const text = JSON.stringify(page.settings.peek().keys, null, 2);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "application/json" }));
    link.download = "rafcon-keys.json";
    link.click();
    URL.revokeObjectURL(link.href);
  };
  return (
    <>
      <Button
        onClick={() => {
          page.settings.value = { ...page.settings.peek(), keys: {} };
        }}
      >
        Reset all
      </Button>
      <label className="button button-plain">
        Import…
        <input
          type="file"
          accept="application/json"
          className="visually-hidden"
          onChange={(event) => void take(event.currentTarget.files?.[0])}
        />
      </label>
      <Button onClick={give}>Export</Button>
    </>
  );
}
