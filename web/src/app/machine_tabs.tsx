/** The machines that are open in this page, each with a mark while a run of it is active, and one for edits that do not lie on disk. */

import { Play, Plus, X } from "lucide-react";
import { type KeyboardEvent, useState } from "react";
import { entryOf } from "../commands/menus.ts";
import { isChanged } from "../commands/save.ts";
import { clock1s } from "../store/page/clock1s.ts";
import type { OpenTab } from "../store/page/page.ts";
import { isUnconfirmed, runningBeside } from "../store/run/running.ts";
import { IconButton } from "../ui/button.tsx";
import { ContextMenu } from "../ui/menu.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useShownKey } from "./keys_shown.ts";
import { useSession } from "./session_context.tsx";

export function MachineTabs() {
  const { page, commands, context } = useSession();
  const shown = useShownKey();
  const tabs = useSignal(page.tabs);
  const active = useSignal(page.active);
  const step = (event: KeyboardEvent, by: number) => {
    const at = active ? tabs.indexOf(active) : -1;
    const next = tabs[(at + by + tabs.length) % tabs.length];
    if (!next) return;
    event.preventDefault();
    page.active.value = next;
    const list = event.currentTarget.querySelectorAll<HTMLElement>("[role=tab]");
    list[tabs.indexOf(next)]?.focus();
  };
  return (
    <div className="tabs">
      <div
        role="tablist"
        aria-label="Open machines"
        className="tabs-list"
        onKeyDown={(event) => {
          if (event.key === "ArrowRight") step(event, 1);
          if (event.key === "ArrowLeft") step(event, -1);
        }}
      >
        {tabs.map((tab) => (
          <MachineTab key={tab.session.id} tab={tab} active={tab === active} />
        ))}
      </div>
      <IconButton
        label="Open a machine"
        icon={<Plus size={15} />}
        keys={shown("file.open")}
        onClick={() => commands.run("file.open", context())}
      />
    </div>
  );
}

function MachineTab({ tab, active }: { tab: OpenTab; active: boolean }) {
  const { page, commands, context } = useSession();
  const { machine } = tab.session;
  useSignal(tab.session.version);
  const [menu, setMenu] = useState<{ x: number; y: number } | null>(null);
  const changed = useComputed(() => isChanged(tab), [tab]);
  const file = useComputed(() => tab.session.status.value?.summary.file ?? null, [tab]);
  const running = useComputed(() => runningBeside(page, tab).length, [page, tab]);
  const isOld = useComputed(() => isUnconfirmed(page, tab, clock1s.value), [page, tab]);
  const name = machine.state(machine.root)?.name ?? "";
  const facts = [
    file ? `${file.project} / ${file.path}` : "not saved yet",
    ...(changed && file ? ["has unsaved edits"] : []),
    ...(running > 0 ? [runningInWords(running, isOld)] : []),
  ];
  const close = () => commands.run("file.close", context(), tab);
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: the middle button is a shortcut for the close button
    <div
      className={`tab ${active ? "tab-active" : ""}`}
      onMouseUp={(event) => event.button === 1 && close()}
      onContextMenu={(event) => {
        event.preventDefault();
        page.active.value = tab;
        setMenu({ x: event.clientX, y: event.clientY });
      }}
    >
      <button
        type="button"
        role="tab"
        aria-selected={active}
        tabIndex={active ? 0 : -1}
        className="tab-name"
        title={facts.join(", ")}
        aria-keyshortcuts="Delete"
        onKeyDown={(event) => event.key === "Delete" && close()}
        onClick={() => {
          page.active.value = tab;
        }}
      >
        {running > 0 && (
          <span className={isOld ? "tab-runs is-old" : "tab-runs"}>
            <Play size={11} aria-hidden />
          </span>
        )}
        {name}
        {running > 0 && <span className="visually-hidden">, {runningInWords(running, isOld)}</span>}
        {changed && (
          <span className="tab-changed">
            <span className="visually-hidden">, changed</span>
          </span>
        )}
      </button>
      {/* By keyboard: Delete on the tab. A list of tabs has tabs only. */}
      <button
        type="button"
        className="tab-close"
        tabIndex={-1}
        aria-hidden
        title={`Close ${name}`}
        onClick={close}
      >
        <X size={13} aria-hidden />
      </button>
      {menu && (
        <ContextMenu
          label={name}
          at={menu}
          onClose={() => setMenu(null)}
          items={TAB_COMMANDS.flatMap((id) => {
            const command = commands.get(id);
            return command
              ? [entryOf({ commands, context: context(), keys: () => [] }, command)]
              : [];
          })}
        />
      )}
    </div>
  );
}

const TAB_COMMANDS = [
  "file.save",
  "file.save-as",
  "file.reload",
  "file.compare",
  "file.close",
  "file.close-others",
  "file.close-all",
] as const;

function runningInWords(count: number, isOld: boolean): string {
  const runs = count === 1 ? "a run is active" : `${count} runs are active`;
  return isOld ? `${runs} as of the last news` : runs;
}
