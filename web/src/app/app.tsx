/** The whole page: who is let in sees the upper edge, the canvas and the panels. */

import { useCallback, useEffect, useMemo, useState } from "react";
import { PanelHostProvider } from "../panels/context.tsx";
import { LostTexts } from "../ui/field.tsx";
import { onDemand } from "../ui/on_demand.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { listenForTips } from "../ui/tips.ts";
import { listenToClipboard } from "./clipboard_events.ts";
import { OpenDialogs } from "./dialogs/dialogs.tsx";
import { FirstPanes, FirstPanesPort } from "./first_panes.tsx";
import { HostedParts } from "./hosted.tsx";
import { listenToKeys } from "./keyboard.ts";
import { guardLeaving } from "./leaving.ts";
import { Login, Unreachable } from "./login.tsx";
import { PanelGuard } from "./panel_guard.tsx";
import { preloadParts, watchRobotsOnceThereAre } from "./preload.ts";
import { tellOfRuns } from "./run_notices.ts";
import { type AppSession, type DockPort, NO_DOCK } from "./session.ts";
import { SessionProvider, useSession } from "./session_context.tsx";
import { Toasts } from "./toasts.tsx";
import { TopBar } from "./top_bar.tsx";
import "./app.css";

export function App({ session }: { session: AppSession }) {
  const host = useMemo(() => ({ commands: session.commands, context: session.context }), [session]);
  const lost = useCallback(
    (text: string) => session.page.tell({ level: "warning", text }),
    [session],
  );
  return (
    <SessionProvider value={session}>
      <PanelHostProvider value={host}>
        <LostTexts.Provider value={lost}>
          <AuthGate />
          <OpenDialogs />
        </LostTexts.Provider>
        <Toasts />
      </PanelHostProvider>
    </SessionProvider>
  );
}

/** A user who was logged in stays so during a disconnection. */
function AuthGate() {
  const { page } = useSession();
  const link = useSignal(page.server.link);
  const [wasIn, setWasIn] = useState(false);
  useEffect(() => {
    if (link.state === "up") setWasIn(true);
    if (link.state === "refused") setWasIn(false);
  }, [link]);
  if (link.state === "refused") return <Login reason={link.reason} />;
  if (wasIn || link.state === "up") return <Workspace />;
  return (
    <Unreachable
      reason={link.state === "down" ? `The server does not respond: ${link.reason}` : "Connecting…"}
    />
  );
}

const Dock = onDemand(
  async () => (await import("./dock.tsx")).Dock,
  (words) => <div className="app-dock-failed">{words}</div>,
);

function Workspace() {
  const session = useSession();
  const isFirst = useComputed(() => isBeforeDock(session.dock.value), [session]);
  useEffect(() => {
    const stops = [
      listenToKeys(session, window),
      listenToClipboard(session, document),
      listenForTips(document),
      guardLeaving(session, window),
      tellOfRuns(session),
      watchRobotsOnceThereAre(session.page),
      preloadParts(session.page),
    ];
    return () => {
      for (const stop of stops) stop();
    };
  }, [session]);
  return (
    <div className="app">
      <PanelGuard name="The top bar" page={session.page}>
        <TopBar />
      </PanelGuard>
      <div className="app-dock">
        {isFirst && <FirstPanes />}
        <Dock />
      </div>
      <HostedParts />
    </div>
  );
}

function isBeforeDock(dock: DockPort): boolean {
  return dock === NO_DOCK || dock instanceof FirstPanesPort;
}
