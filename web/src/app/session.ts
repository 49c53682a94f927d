/** The page as the shell holds it together: page, commands, what dialogs wait for an answer, which canvas is in front. */

import { type ReadonlySignal, type Signal, signal } from "@preact/signals-core";
import type { CanvasControl } from "../canvas/control.ts";
import type { CommandContext, Commands, Dialogs, Layouts, Shell } from "../commands/command.ts";
import { MISSION_PANEL } from "../commands/mission.ts";
import { withStateNames } from "../store/page/names.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import type { UserQuestion } from "./question.ts";

/** Dialogs of commands, and the questions of the shell. */
export interface AllDialogs extends Dialogs {
  readonly question: { readonly asks: UserQuestion; readonly answer: string | boolean };
}

/** A dialog that is open. */
export interface OpenDialog {
  readonly id: number;
  readonly name: keyof AllDialogs;
  readonly asks: unknown;
  readonly answer: (answer: unknown) => void;
}

export interface AppSession {
  readonly page: Page;
  readonly commands: Commands;
  readonly context: () => CommandContext;
  readonly canvas: Signal<CanvasControl | null>;
  readonly dialogs: ReadonlySignal<readonly OpenDialog[]>;
  /** Search text of the palette; null while it is closed. */
  readonly palette: Signal<string | null>;
  /** Shows panels; set by the dock. */
  readonly dock: Signal<DockPort>;
}

/** True if visible mission control shows this tab's run, which is then shown nowhere else. Reads signals. */
export function isInMission({ page, dock }: AppSession, tab: OpenTab): boolean {
  return page.active.value === tab && dock.value.isInSight(MISSION_PANEL);
}

/** Functions of the dock for the shell. */
export interface DockPort {
  readonly showPanel: (panel: string) => void;
  /** Returns floating panels and panels in windows to their side. */
  readonly dock: (panels: readonly string[]) => void;
  /** True if a panel is visible. Reads signals. */
  readonly isInSight: (panel: string) => boolean;
  readonly layouts: Layouts;
}

/** Before the page has a place for panels. */
export const NO_DOCK: DockPort = {
  showPanel: () => {},
  dock: () => {},
  isInSight: () => false,
  layouts: {
    names: () => [],
    own: () => [],
    apply: () => {},
    save: () => {},
    remove: () => {},
    isShown: () => false,
    toggle: () => {},
    toggleFocus: () => {},
    panels: () => [],
  },
};

export function newSession(page: Page, commands: Commands): AppSession {
  const canvas = signal<CanvasControl | null>(null);
  const palette = signal<string | null>(null);
  const dock = signal(NO_DOCK);
  const dialogs = signal<readonly OpenDialog[]>([]);
  const open = dialogOpener(dialogs);
  const ask = (question: UserQuestion) => open("question", withNames(page, question));
  const shell: Shell = {
    confirm: async (question) => (await ask({ kind: "confirm", ...question })) === true,
    choose: async <T extends string>(question: Omit<UserQuestion & { kind: "choose" }, "kind">) =>
      (await ask({ kind: "choose", ...question })) as T | null,
    prompt: async (question) => (await ask({ kind: "prompt", ...question })) as string | null,
    dialog: open,
    showPanel: (panel) => dock.peek().showPanel(panel),
    openPalette: (query = "") => {
      palette.value = query;
    },
    overview: () => void setTimeout(() => canvas.peek()?.fit([]), STANDING_MS),
    get layouts() {
      return dock.peek().layouts;
    },
  };
  const context = () => ({ page, tab: page.active.value, canvas: canvas.value, shell });
  return { page, commands, context, canvas, dialogs, palette, dock };
}

/** Time after which moved panels and the canvas have their sizes, in ms. */
const STANDING_MS = 200;

/** The question without ids of states. */
function withNames({ tabs, active }: Page, question: UserQuestion): UserQuestion {
  if (question.kind === "prompt") return question;
  const named = (text: string) => withStateNames(tabs.peek(), active.peek(), text);
  const text = named(question.text);
  if (question.kind === "confirm") return { ...question, text };
  return { ...question, text, ...(question.list ? { list: question.list.map(named) } : {}) };
}

/** Opens dialogs one upon the other, and closes each when it is answered. */
function dialogOpener(dialogs: Signal<readonly OpenDialog[]>) {
  let count = 0;
  return <N extends keyof AllDialogs>(name: N, asks: AllDialogs[N]["asks"]) =>
    new Promise<AllDialogs[N]["answer"] | null>((resolve) => {
      count += 1;
      const id = count;
      const answer = (given: unknown) => {
        dialogs.value = dialogs.peek().filter((other) => other.id !== id);
        resolve(given as AllDialogs[N]["answer"] | null);
      };
      dialogs.value = [...dialogs.peek(), { id, name, asks, answer }];
    });
}
