/** The kinds of states, to be dragged onto the canvas or put into what is selected by a click. */

import { shownKey } from "../commands/keys.ts";
import { DRAGGED_TYPE, dragged } from "../store/page/dragged.ts";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useKeys } from "./keys_shown.ts";
import { KIND_ICONS, KIND_TITLES, NEW_KINDS } from "./kinds.ts";
import { useSession } from "./session_context.tsx";

const SHORT = {
  execution: "Execution",
  hierarchy: "Hierarchy",
  barrier: "Barrier",
  preemptive: "Preemptive",
};

export function InsertPalette() {
  const { commands, context, page } = useSession();
  const keys = useKeys();
  useSignal(page.active);
  const can = useComputed(
    () => commands.get("insert.execution")?.enabled?.(context()) !== false,
    [commands],
  );
  return (
    <div className="tool-group" role="toolbar" aria-label="Add states">
      {NEW_KINDS.map((kind) => {
        const Icon = KIND_ICONS[kind];
        const id = `insert.${kind}` as const;
        const [key] = keys(id);
        return (
          <button
            key={kind}
            type="button"
            className="insert-item"
            disabled={!can}
            draggable={can}
            aria-label={`Add ${KIND_TITLES[kind].toLowerCase()}`}
            title={`${KIND_TITLES[kind]}: drag it onto the canvas, or click${key ? ` (${shownKey(key)})` : ""}`}
            onClick={() => commands.run(id, context())}
            onDragStart={(event) => {
              dragged.value = { insert: kind };
              event.dataTransfer.effectAllowed = "copy";
              event.dataTransfer.setData(DRAGGED_TYPE, JSON.stringify({ insert: kind }));
            }}
            onDragEnd={() => {
              dragged.value = null;
            }}
          >
            <Icon size={15} aria-hidden />
            <span>{SHORT[kind]}</span>
          </button>
        );
      })}
    </div>
  );
}
