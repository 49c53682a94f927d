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
import {
  Ellipsis,
  Maximize2,
  Minimize2,
  PanelsTopLeft,
  PictureInPicture2,
  SquareArrowOutUpRight,
} from "lucide-react";
import { useEffect, useMemo, useRef, useState } from "react";
import { MISSION_PANEL } from "../commands/mission.ts";
import { isValueDrag } from "../panels/parts/value/dragged_value.ts";
import { useIsOld } from "../panels/run_age.ts";
import { BROWSER_STORE } from "../store/local_store.ts";
import { pageBase } from "../store/page/base.ts";
import { IconButton } from "../ui/button.tsx";
import { keepCompositions } from "../ui/composition.ts";
import { useKeptScroll } from "../ui/kept_scroll.ts";
import { ContextMenu, type MenuItem } from "../ui/menu.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { listenForTips } from "../ui/tips.ts";
import { undoTranslations } from "../ui/translation.ts";
import { listenToClipboard } from "./clipboard_events.ts";
import { DockControl } from "./dock_control.ts";
import { FirstPanesPort } from "./first_panes.tsx";
import { HostedPlace } from "./hosted.tsx";
import { initialLayout } from "./initial_layout.ts";
import { listenToKeys } from "./keyboard.ts";
import { NARROW, SMALL } from "./mission_place.ts";
import { PanelGuard } from "./panel_guard.tsx";
import { PANELS, panelOf } from "./panels.tsx";
import { reportTranslation } from "./report_errors.ts";
import { useSession } from "./session_context.tsx";
import { applyTheme } from "./theme.ts";

const THEME = { ...themeAbyss, name: "rafcon", className: "dockview-theme-rafcon", gap: 0 };

export function Dock() {
  const session = useSession();
  const [api, setApi] = useState<DockviewApi | null>(null);
  useEffect(() => {
    if (!api) return;
    const control = new DockControl(api, BROWSER_STORE);
    const narrow = window.matchMedia(NARROW);
    const small = window.matchMedia(SMALL);
    const fold = () => control.fold(small.matches);
    control.stack(narrow.matches);
    control.restore(initialLayout(session.page));
    const before = session.dock.peek();
    session.dock.value = control;
    const stack = () => {
      if (control.stack(narrow.matches)) session.context().shell.overview();
    };
    // The dock has its new size from the next picture on: panels fold before that, and unfold after it.
    const later = (act: () => void) => requestAnimationFrame(() => requestAnimationFrame(act));
    const soon = () => later(stack);
    const foldSoon = () => (small.matches ? fold() : later(fold));
    stack();
    fold();
    narrow.addEventListener("change", soon);
    small.addEventListener("change", foldSoon);
    if (before instanceof FirstPanesPort) before.handOver(control);
    const opened = api.onDidAddPopoutGroup(({ window: view }) => {
      const stops = [
        keepCompositions(view),
        listenToKeys(session, view),
        listenToClipboard(session, view.document),
        listenForTips(view.document),
        applyTheme(session.page, view),
        undoTranslations(view.document, () => reportTranslation(session.page)),
      ];
      view.addEventListener("pagehide", () => {
        for (const stop of stops) stop();
      });
    });
    const failed = api.onDidOpenPopoutWindowFail(() =>
      session.page.tell({
        level: "warning",
        text: "The browser blocked the window. Allow pop-ups for this page and try again.",
      }),
    );
    return () => {
      narrow.removeEventListener("change", soon);
      small.removeEventListener("change", foldSoon);
      opened.dispose();
      failed.dispose();
      control.dispose();
    };
  }, [api, session]);
  const components = useMemo(
    () => ({
      canvas: CanvasPanel,
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
      popoutUrl={`${pageBase()}/popout.html`}
      defaultRenderer="onlyWhenVisible"
      onReady={(event) => setApi(event.api)}
    />
  );
}

function CanvasPanel() {
  return <HostedPlace id="canvas" />;
}

function PanelPlace({ api }: IDockviewPanelProps) {
  const panel = panelOf(api.id);
  const { page } = useSession();
  const isOld = useIsOld(page);
  const place = useRef<HTMLDivElement>(null);
  useKeptScroll(place);
  if (!panel) return null;
  const Component = panel.component;
  return (
    <div ref={place} className={isOld ? "panel is-old" : "panel"}>
      {api.id === MISSION_PANEL ? (
        <HostedPlace id={MISSION_PANEL} />
      ) : (
        <PanelGuard name={panel.title} page={page}>
          <Component />
        </PanelGuard>
      )}
    </div>
  );
}

function PanelTab({ api }: IDockviewPanelHeaderProps) {
  const { page } = useSession();
  const panel = panelOf(api.id);
  const active = useSignal(page.active);
  const count = useComputed(() => panel?.count?.(active) ?? 0, [panel, active]);
  if (!panel) return null;
  const Icon = panel.icon;
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: the tab around it is what is pressed; this is about what is dragged over it
    <div
      className="dock-tab"
      onDragEnter={(event) => {
        if (panel.takesValues && isValueDrag(event)) api.setActive();
      }}
    >
      <Icon size={13} aria-hidden />
      <span>{panel.title}</span>
      {count > 0 && <span className="dock-tab-count">{count}</span>}
    </div>
  );
}

/** Actions on a group of panels, in one button so that the tabs have space. */
function GroupActions({ api, containerApi, activePanel, group }: IDockviewHeaderActionsProps) {
  const { dock } = useSession();
  const [menu, setMenu] = useState<{ x: number; y: number } | null>(null);
  if (!activePanel) return null;
  const place = api.location.type;
  const big = api.isMaximized();
  const items: MenuItem[] = [
    {
      id: "size",
      title: big ? "Restore size" : "Maximize",
      icon: big ? <Minimize2 size={13} /> : <Maximize2 size={13} />,
      disabled: place !== "grid",
      run: () => (big ? api.exitMaximized() : api.maximize()),
    },
    {
      id: "float",
      title: "Float",
      icon: <PictureInPicture2 size={13} />,
      disabled: place === "floating",
      run: () => containerApi.addFloatingGroup(group, FLOATING),
    },
    {
      id: "window",
      title: "Open in a window",
      icon: <SquareArrowOutUpRight size={13} />,
      disabled: place === "popout",
      run: () => void containerApi.addPopoutGroup(group),
    },
    {
      id: "dock",
      title: "Dock",
      icon: <PanelsTopLeft size={13} />,
      disabled: place === "grid",
      run: () => dock.peek().dock(group.panels.map(({ id }) => id)),
    },
    "separator",
    { id: "close", title: `Close ${activePanel.title}`, run: () => activePanel.api.close() },
  ];
  return (
    <div className="dock-actions">
      <IconButton
        label={`${activePanel.title} panel menu`}
        icon={<Ellipsis size={14} />}
        onClick={(event) => {
          const { left, bottom } = event.currentTarget.getBoundingClientRect();
          setMenu({ x: left, y: bottom });
        }}
      />
      {menu && <ContextMenu label="Panel" at={menu} items={items} onClose={() => setMenu(null)} />}
    </div>
  );
}

/** Initial bounds of a floating panel, in CSS pixels. */
const FLOATING = { width: 380, height: 520, position: { top: 80, right: 420 } };
