/** Layers and zoom of the canvas. */

import {
  ArrowRightLeft,
  CircleSlash2,
  Crosshair,
  Flame,
  Grid3x3,
  type LucideIcon,
  Maximize,
  ScanSearch,
  Tag,
  Variable,
  Waypoints,
  ZoomIn,
  ZoomOut,
} from "lucide-react";
import type { FreeCommandId } from "../store/page/command_arguments.ts";
import type { OpenTab } from "../store/page/page.ts";
import { IconButton } from "../ui/button.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useShownKey } from "./keys_shown.ts";
import { useSession } from "./session_context.tsx";

const MODES: readonly (readonly [FreeCommandId, LucideIcon])[] = [
  ["view.transitions", ArrowRightLeft],
  ["view.data-flows", Waypoints],
  ["view.names", Tag],
  ["view.values", Variable],
  ["view.aborted", CircleSlash2],
  ["view.grid", Grid3x3],
];

const LOOK: readonly (readonly [FreeCommandId, LucideIcon])[] = [
  ["view.zoom-out", ZoomOut],
  ["view.zoom-in", ZoomIn],
  ["view.zoom-selection", ScanSearch],
  ["view.fit", Maximize],
];

const HEATS = { off: "none", count: "how often states ran", time: "how long states ran" };

const FLOWS = { selection: "of the selection", all: "all", none: "none" };

export function CanvasTools({ tab }: { tab: OpenTab }) {
  const { commands, context } = useSession();
  const shown = useShownKey();
  const modes = useSignal(tab.view.modes);
  const some = useComputed(() => tab.view.selection.value.size > 0, [tab]);
  const button = (
    [id, Icon]: readonly [FreeCommandId, LucideIcon],
    pressed?: boolean,
    words = "",
  ) => (
    <IconButton
      key={id}
      label={(commands.get(id)?.title ?? id) + words}
      icon={<Icon size={15} />}
      keys={shown(id)}
      pressed={pressed}
      disabled={id === "view.zoom-selection" && !some}
      onClick={() => commands.run(id, context())}
    />
  );
  const watch = useSignal(tab.run);
  const heat = useSignal(tab.view.heat);
  const follows = useSignal(tab.view.follows);
  return (
    <>
      {watch && (
        <div className="tool-group" role="toolbar" aria-label="Run on the canvas">
          {button(["run.follow", Crosshair], follows)}
          {button(["view.heat", Flame], heat !== "off", `: ${HEATS[heat]}`)}
        </div>
      )}
      <div className="tool-group" role="toolbar" aria-label="Shown on the canvas">
        {MODES.map((mode) =>
          mode[0] === "view.data-flows"
            ? button(mode, modes.dataFlows !== "none", `: ${FLOWS[modes.dataFlows]}`)
            : button(mode, commands.get(mode[0])?.checked?.(context())),
        )}
      </div>
      <div className="tool-group" role="toolbar" aria-label="Zoom">
        {LOOK.map((look) => button(look))}
      </div>
    </>
  );
}
