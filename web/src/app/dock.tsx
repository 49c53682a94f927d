/** The panels around the canvas: they dock, tab, float, fold, and go into windows of their own. */

import "dockview-react/dist/styles/dockview.css";
import "./dock.css";
import {
  type DockviewApi,
  DockviewReact,
  type IDockviewHeaderActionsProps,
  type IDockviewPanelHeaderProps,
  type IDockviewPanelProps,
  themeAbyss,
} from "dockview-react";
import { Maximize2, Minimize2, PictureInPicture2, SquareArrowOutUpRight } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { shedOf } from "../store/shed.ts";
import { IconButton } from "../ui/button.tsx";
import { useSignal } from "../ui/signals.ts";
import { Centre } from "./centre.tsx";
import { listenToClipboard } from "./clipboard_events.ts";
import { DockControl } from "./dock_control.ts";
import { listenToKeys } from "./keyboard.ts";
import { PanelGuard } from "./panel_guard.tsx";
import { PANELS, panelOf } from "./panels.tsx";
import { useDerived, useSession } from "./provided.tsx";

const THEME = { ...themeAbyss, name: "rafcon", className: "dockview-theme-rafcon", gap: 0 };

export function Dock() {
  const session = useSession();
  const [api, setApi] = useState<DockviewApi | null>(null);
  useEffect(() => {
    if (!api) return;
    const control = new DockControl(
      api,
      shedOf(() => window.localStorage),
    );
    control.restore();
    session.dock.value = control;
    const opened = api.onDidAddPopoutGroup(({ window: view }) => {
      const stops = [listenToKeys(session, view), listenToClipboard(session, view.document)];
      const { theme } = document.documentElement.dataset;
      if (theme) view.document.documentElement.dataset["theme"] = theme;
      view.addEventListener("pagehide", () => {
        for (const stop of stops) stop();
      });
    });
    const failed = api.onDidOpenPopoutWindowFail(() =>
      session.page.tell({
        level: "warning",
        text: "The browser did not open a window: allow pop-ups for this page and try again.",
      }),
    );
    return () => {
      opened.dispose();
      failed.dispose();
      control.dispose();
    };
  }, [api, session]);
  const components = useMemo(
    () => ({
      canvas: Centre,
      ...Object.fromEntries(PANELS.map(({ id }) => [id, PanelPlace])),
    }),
    [],
  );
  return (
    <DockviewReact
      theme={THEME}
      components={components}
      defaultTabComponent={PanelTab}
      rightHeaderActionsComponent={GroupActions}
      popoutUrl="/popout.html"
      defaultRenderer="onlyWhenVisible"
      onReady={(event) => setApi(event.api)}
    />
  );
}

function PanelPlace({ api }: IDockviewPanelProps) {
  const panel = panelOf(api.id);
  if (!panel) return null;
  const Component = panel.component;
  return (
    <div className="panel">
      <PanelGuard name={panel.title}>
        <Component />
      </PanelGuard>
    </div>
  );
}

function PanelTab({ api }: IDockviewPanelHeaderProps) {
  const { page } = useSession();
  const panel = panelOf(api.id);
  const active = useSignal(page.active);
  const count = useDerived(() => panel?.count?.(active) ?? 0, [panel, active]);
  if (!panel) return null;
  const Icon = panel.icon;
  return (
    <div className="dock-tab">
      <Icon size={13} aria-hidden />
      <span>{panel.title}</span>
      {count > 0 && <span className="dock-tab-count">{count}</span>}
    </div>
  );
}

function GroupActions({ api, containerApi, activePanel, group }: IDockviewHeaderActionsProps) {
  const [place, setPlace] = useState(api.location.type);
  const [big, setBig] = useState(api.isMaximized());
  useEffect(() => {
    const moved = api.onDidLocationChange((event) => setPlace(event.location.type));
    const grown = containerApi.onDidMaximizedGroupChange(() => setBig(api.isMaximized()));
    return () => {
      moved.dispose();
      grown.dispose();
    };
  }, [api, containerApi]);
  if (!activePanel) return null;
  const isDocked = place === "grid";
  return (
    <div className="dock-actions">
      {isDocked && (
        <IconButton
          label={big ? "Make panel smaller" : "Make panel larger"}
          icon={big ? <Minimize2 size={13} /> : <Maximize2 size={13} />}
          onClick={() => (big ? api.exitMaximized() : api.maximize())}
        />
      )}
      <IconButton
        label={isDocked ? "Float panel" : "Dock panel"}
        icon={<PictureInPicture2 size={13} />}
        onClick={() => {
          if (isDocked) containerApi.addFloatingGroup(group);
          else api.moveTo({ position: "right" });
        }}
      />
      {place !== "popout" && (
        <IconButton
          label="Open in a window"
          icon={<SquareArrowOutUpRight size={13} />}
          onClick={() => void containerApi.addPopoutGroup(group)}
        />
      )}
    </div>
  );
}
