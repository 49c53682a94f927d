/** The tabs of the page, one for each machine. Independent of how machines are loaded. */

import { batch, signal } from "@preact/signals-core";
import type { MachineSession } from "../store/document/machine_session.ts";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab } from "../store/page/page.ts";
import { forgetGone } from "../store/page/selection.ts";
import { newView } from "../store/page/view.ts";

export function newTabs() {
  const tabs = signal<readonly OpenTab[]>([]);
  const active = signal<OpenTab | null>(null);
  const coming = new Map<string, Promise<OpenTab>>();

  const put = (session: MachineSession, run: Watch | null, inBackground: boolean): OpenTab => {
    const tab: OpenTab = { session, view: newView(), run: signal(run) };
    session.onChange(() => forgetGone(tab.view, session.machine));
    batch(() => {
      tabs.value = [...tabs.peek(), tab];
      if (!inBackground) active.value = tab;
    });
    return tab;
  };

  const front = (tab: OpenTab): OpenTab => {
    active.value = tab;
    return tab;
  };

  /** Brings the tab of a machine to the front, or makes one, with the run that is shown on it; `inBackground`: what is in front stays. */
  const enter = (
    id: string,
    get: () => Promise<MachineSession>,
    run: Watch | null = null,
    inBackground = false,
  ): Promise<OpenTab> => {
    const there = tabs.peek().find(({ session }) => session.id === id);
    if (there) return Promise.resolve(inBackground ? there : front(there));
    const before = coming.get(id);
    if (before) return before;
    const entering = get()
      .then((session) => put(session, run, inBackground))
      .finally(() => coming.delete(id));
    coming.set(id, entering);
    return entering;
  };

  const leave = (tab: OpenTab): void => {
    const before = tabs.peek();
    const at = before.indexOf(tab);
    if (at < 0) return;
    tab.session.close();
    const kept = before.filter((other) => other !== tab);
    batch(() => {
      tabs.value = kept;
      if (active.peek() === tab) active.value = kept[Math.min(at, kept.length - 1)] ?? null;
    });
  };

  return { tabs, active, front, enter, leave };
}
