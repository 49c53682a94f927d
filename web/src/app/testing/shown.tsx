/** A part of the page around the panels in a document, for tests: with a machine in front and a run of it. */

import { signal } from "@preact/signals-core";
import type { ReactElement } from "react";
import { allCommands } from "../../commands/all.ts";
import { testContext } from "../../commands/testing/context.ts";
import type { RunSummary } from "../../model/generated/protocol.ts";
import { PanelHostProvider } from "../../panels/context.tsx";
import type { MachineSession } from "../../store/document/machine_session.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { mount } from "../../ui/testing/mounted.tsx";
import { type AppSession, newSession } from "../session.ts";
import { SessionProvider } from "../session_context.tsx";

/** Those of an engineer. */
const RIGHTS = ["observe", "command", "start", "edit"] as const;

export interface Beside {
  readonly session?: MachineSession;
  readonly watch?: Watch | null;
  readonly runs?: readonly RunSummary[];
  readonly robots?: Page["robots"];
  /** Answers of the server by method and path. */
  readonly serve?: (request: string) => unknown;
}

export interface Shown {
  readonly place: HTMLElement;
  readonly session: AppSession;
}

export function shown(part: (tab: OpenTab) => ReactElement, beside: Beside = {}): Shown {
  const { page: plain, tab: alone } = testContext("R hierarchy", {
    rights: RIGHTS,
    serve: beside.serve ?? (() => undefined),
  });
  const machineSession = beside.session ?? alone.session;
  const tab: OpenTab = { ...alone, session: machineSession, run: signal(beside.watch ?? null) };
  const pulse = { heard_ms: 0, server_ms: 0, old_ms: Number.POSITIVE_INFINITY, ahead_ms: 0 };
  const page = {
    ...plain,
    server: { ...plain.server, pulse: signal({ ...pulse, delay_ms: 3 }) },
    projects: signal([]),
    libraries: signal([]),
    robots: beside.robots ?? signal([]),
    serverStatus: signal(null),
    runs: { all: signal(beside.runs ?? []), get: () => new Promise(() => {}) },
    tabs: signal([tab]),
    active: signal<OpenTab | null>(tab),
  } as unknown as Page;
  const session = newSession(page, allCommands());
  const host = { commands: session.commands, context: session.context };
  const place = mount(
    <SessionProvider value={session}>
      <PanelHostProvider value={host}>{part(tab)}</PanelHostProvider>
    </SessionProvider>,
  );
  return { place, session };
}
