/** The middle of the page: the machine in front on its canvas, with where one is and what shows; or how to begin. */

import { MISSION_PANEL } from "../commands/mission.ts";
import { mayEdit } from "../store/page/rights.ts";
import { useComputed, useSignal } from "../ui/signals.ts";
import { Bars } from "./bars.tsx";
import { Breadcrumb } from "./breadcrumb.tsx";
import { CanvasPlace } from "./canvas_place.tsx";
import { CanvasTools } from "./canvas_tools.tsx";
import { InsertPalette } from "./insert_palette.tsx";
import { useSession } from "./session_context.tsx";
import { StartPage } from "./start_page.tsx";
import "./canvas_area.css";

export function CanvasArea() {
  const { page, dock } = useSession();
  const tab = useSignal(page.active);
  const draws = useComputed(
    () =>
      mayEdit(page) &&
      page.active.value?.session.fixed === null &&
      !dock.value.isInSight(MISSION_PANEL),
    [page, dock],
  );
  if (!tab) return <StartPage />;
  return (
    <main className="canvas-area">
      <div className="canvas-area-bar">
        <Breadcrumb tab={tab} />
        {draws && <InsertPalette />}
        <CanvasTools tab={tab} />
      </div>
      <Bars tab={tab} />
      <CanvasPlace key={tab.session.id} tab={tab} />
    </main>
  );
}
