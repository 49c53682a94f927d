/** The place of the canvas of a machine, with its context menu. */

import { signal } from "@preact/signals-core";
import { CircleAlert } from "lucide-react";
import { useEffect, useRef, useState } from "react";
import type { CanvasControl } from "../canvas/control.ts";
import { mountCanvas } from "../canvas/mount.ts";
import type { CanvasPicture } from "../canvas/picture.ts";
import type { CommandContext } from "../commands/command.ts";
import { contextMenu } from "../commands/menus.ts";
import type { ElementRef } from "../model/element.ts";
import type { Point } from "../model/geometry.ts";
import { useIsOld } from "../panels/run_age.ts";
import type { OpenTab } from "../store/page/page.ts";
import { Button } from "../ui/button.tsx";
import { ContextMenu } from "../ui/menu.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { BranchSteps } from "./branch_steps.tsx";
import { HeatLegend } from "./heat_legend.tsx";
import { useKeys } from "./keys_shown.ts";
import { runOverlay } from "./run_overlay.ts";
import { SentCommands } from "./sent_commands.tsx";
import { isInMission } from "./session.ts";
import { useSession } from "./session_context.tsx";

const NO_MARKS = new Map<never, never>();
const NO_FAULT = signal<string | null>(null);

interface CanvasMenu {
  readonly at: Point;
  readonly elements: readonly ElementRef[];
  /** Position in the machine where it was opened. */
  readonly pointer: ReturnType<CanvasControl["pointer"]>;
}

/** New elements are placed where the menu was opened, not at the present pointer. */
function asOpened(context: CommandContext, { pointer }: CanvasMenu): CommandContext {
  return context.canvas
    ? { ...context, canvas: { ...context.canvas, pointer: () => pointer } }
    : context;
}

export function CanvasPlace({ tab }: { tab: OpenTab }) {
  const session = useSession();
  const { page, commands, context, canvas } = session;
  const keys = useKeys();
  const place = useRef<HTMLDivElement>(null);
  const isOld = useIsOld(page);
  const watch = useSignal(tab.run);
  const isInMissionControl = useComputed(() => isInMission(session, tab), [session, tab]);
  const [picture, setPicture] = useState<CanvasPicture | null>(null);
  const [menu, setMenu] = useState<CanvasMenu | null>(null);
  useEffect(() => {
    if (!place.current) return;
    const shown = runOverlay(page, tab);
    const mounted = mountCanvas(place.current, {
      tab,
      page,
      run: (call) => void commands.call(call, context()),
      runOverlay: () => ({ ...shown.read(), differences: tab.view.marks.value ?? NO_MARKS }),
      menuAt: (at, elements) => setMenu({ at, elements, pointer: mounted.control.pointer() }),
    });
    canvas.value = mounted.control;
    setPicture(mounted.picture);
    return () => {
      if (canvas.peek() === mounted.control) canvas.value = null;
      shown.stop();
      mounted.dispose();
    };
  }, [tab, page, commands, context, canvas]);
  const fault = useSignal(picture?.fault ?? NO_FAULT);
  return (
    <div className="canvas-place">
      <div
        ref={place}
        className={`canvas-mount ${isOld ? "is-old" : ""} ${fault === null ? "" : "is-broken"}`}
      />
      {fault !== null && (
        <div className="canvas-fault" role="alert">
          <CircleAlert size={16} aria-hidden />
          <span>The canvas is out of date: it could not be redrawn ({fault}).</span>
          <Button onClick={() => picture?.redraw()}>Redraw</Button>
        </div>
      )}
      {watch && picture && <BranchSteps tab={tab} watch={watch} picture={picture} />}
      <HeatLegend tab={tab} />
      {watch && !isInMissionControl && <SentCommands watch={watch} />}
      {menu && (
        <ContextMenu
          label="Actions"
          at={menu.at}
          items={contextMenu({ commands, context: asOpened(context(), menu), keys }, menu.elements)}
          onClose={() => setMenu(null)}
        />
      )}
    </div>
  );
}
