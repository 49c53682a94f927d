/** First panes of the page, before the dock is loaded: mission control beside the canvas, or the canvas alone. On a slow network the
 * dock takes longer than all that an operator needs at first. */

import "../ui/old.css";
import "./first_panes.css";
import { type Signal, signal } from "@preact/signals-core";
import { useEffect } from "react";
import type { Layouts } from "../commands/command.ts";
import { MISSION_LAYOUT, MISSION_PANEL } from "../commands/mission.ts";
import { useIsOld } from "../panels/run_age.ts";
import { BROWSER_STORE, kept, type LocalStore } from "../store/local_store.ts";
import type { Page } from "../store/page/page.ts";
import { useSignal } from "../ui/signals.ts";
import { HostedPlace } from "./hosted.tsx";
import { initialLayout, takeAsked } from "./initial_layout.ts";
import { LAYOUT_KEY, SHIPPED } from "./layouts.ts";
import type { DockPort } from "./session.ts";
import { useSession } from "./session_context.tsx";

/** Replaces the dock until it is loaded. Keeps the calls meanwhile, and repeats them in the dock. */
export class FirstPanesPort implements DockPort {
  readonly hasMission: Signal<boolean>;
  #wanted: ((dock: DockPort) => void)[] = [];

  constructor(hasMission: boolean) {
    this.hasMission = signal(hasMission);
  }

  readonly isInSight = (panel: string): boolean => panel === MISSION_PANEL && this.hasMission.value;

  readonly showPanel = (panel: string): void => {
    if (panel === MISSION_PANEL) this.hasMission.value = true;
    this.#later((dock) => dock.showPanel(panel));
  };

  readonly dock = (panels: readonly string[]): void => this.#later((dock) => dock.dock(panels));

  readonly layouts: Layouts = {
    names: () => Object.keys(SHIPPED),
    own: () => [],
    apply: (name) => {
      this.hasMission.value = name === MISSION_LAYOUT;
      this.#later((dock) => dock.layouts.apply(name));
    },
    save: (name) => this.#later((dock) => dock.layouts.save(name)),
    remove: (name) => this.#later((dock) => dock.layouts.remove(name)),
    isShown: () => false,
    toggle: (side) => this.#later((dock) => dock.layouts.toggle(side)),
    toggleFocus: () => this.#later((dock) => dock.layouts.toggleFocus()),
    panels: () => [],
  };

  /** Repeats the kept calls in the dock, once. */
  handOver(dock: DockPort): void {
    for (const act of this.#wanted.splice(0)) act(dock);
  }

  #later(act: (dock: DockPort) => void): void {
    this.#wanted.push(act);
  }
}

/** True if the page begins with mission control: by its kept layout, or by the role of the user. */
export function beginsWithMission(page: Page, store: LocalStore): boolean {
  const before = kept<{ readonly panels?: object }>(store, LAYOUT_KEY);
  if (before?.panels) return MISSION_PANEL in before.panels;
  return initialLayout(page) === MISSION_LAYOUT;
}

export function FirstPanes() {
  const session = useSession();
  const { page } = session;
  const isOld = useIsOld(page);
  const port = useSignal(session.dock);
  useEffect(() => {
    const { dock, commands, context } = session;
    dock.value = new FirstPanesPort(beginsWithMission(page, BROWSER_STORE));
    const asked = takeAsked(window);
    if (asked.isMission) commands.run("mission.open", context());
    if (asked.run !== null) commands.run("run.show", context(), asked.run);
  }, [session, page]);
  const hasMission = useSignal(port instanceof FirstPanesPort ? port.hasMission : NO_MISSION);
  return (
    <div className="first-panes">
      {hasMission && (
        <div className={isOld ? "panel is-old" : "panel"}>
          <HostedPlace id="mission" />
        </div>
      )}
      <HostedPlace id="canvas" />
    </div>
  );
}

const NO_MISSION = signal(false);
