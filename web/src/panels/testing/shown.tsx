/** A panel in a document, for tests: beside a machine in short text, a run of it, and the list of runs. */

import { signal } from "@preact/signals-core";
import type { ReactElement } from "react";
import { allCommands } from "../../commands/all.ts";
import { type TestContextOptions, testContext } from "../../commands/testing/context.ts";
import type { RunSummary } from "../../model/generated/protocol.ts";
import type { MachineSession } from "../../store/document/machine_session.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { mount } from "../../ui/testing/mounted.tsx";
import { PanelHostProvider } from "../context.tsx";

export interface Beside {
  readonly machine?: string;
  readonly session?: Partial<MachineSession>;
  readonly watch?: Watch | null;
  readonly runs?: readonly RunSummary[];
  /** How far the server's clock is ahead of this one. */
  readonly ahead_ms?: number;
  /** The server's time when it was received last: now, if nothing else is given. */
  readonly server_ms?: number;
  /** Rights, answers of the user and of the server. */
  readonly options?: TestContextOptions;
}

export function shown(panel: ReactElement, beside: Beside): HTMLElement {
  const {
    page: plain,
    tab: alone,
    shell,
  } = testContext(beside.machine ?? "R hierarchy", beside.options);
  const session: MachineSession = { ...alone.session, ...beside.session };
  const tab: OpenTab = { ...alone, session, run: signal(beside.watch ?? null) };
  const ahead_ms = beside.ahead_ms ?? 0;
  const server_ms = beside.server_ms ?? Date.now() + ahead_ms;
  const pulse = { heard_ms: 0, server_ms, old_ms: Number.POSITIVE_INFINITY, delay_ms: 3 };
  const page = {
    ...plain,
    server: { ...plain.server, pulse: signal({ ...pulse, ahead_ms }) },
    runs: { all: signal(beside.runs ?? []) },
    comingRun: signal(null),
    robots: signal([]),
    active: signal<OpenTab | null>(tab),
  } as unknown as Page;
  const context = () => ({ page, tab, canvas: null, shell });
  return mount(
    <PanelHostProvider value={{ commands: allCommands(), context }}>{panel}</PanelHostProvider>,
  );
}
