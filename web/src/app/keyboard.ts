/** From keys to commands: letters count on the canvas only, what texts need stays with texts. */

import { computed, type ReadonlySignal } from "@preact/signals-core";
import { refusalOf, type UserCommand } from "../commands/command.ts";
import { isCanvasKey, isTextKey, keymap, keyName } from "../commands/keys.ts";
import { whyDisabled } from "../commands/why.ts";
import type { AppSession } from "./session.ts";

/** The focused element. */
type Focus = "canvas" | "text" | "elsewhere";

const TEXTS = "input, textarea, select, [contenteditable]:not([contenteditable=false])";

export function focusOf(target: EventTarget | null): Focus {
  if (!target || !("closest" in target)) return "elsewhere";
  const element = target as HTMLElement;
  if (element.closest(TEXTS)) {
    const isBox = element instanceof HTMLInputElement && /checkbox|radio|button/.test(element.type);
    return isBox ? "elsewhere" : "text";
  }
  const isBody = element === element.ownerDocument?.body;
  return isBody || element.closest("[role=application]") ? "canvas" : "elsewhere";
}

/** True if a key pressed there is for commands. */
export function counts(key: string, focus: Focus): boolean {
  if (focus === "canvas") return true;
  if (focus === "text") return !isTextKey(key);
  return !isCanvasKey(key);
}

/** Commands that the browser's own events of copy, cut and paste are for: with its keys nothing else is to be done. */
const BY_EVENT: Readonly<Record<string, string>> = {
  "edit.copy": "Ctrl+C",
  "edit.cut": "Ctrl+X",
  "edit.paste": "Ctrl+V",
};

/** Commands by key, as settings have them. */
export function keysOf(session: AppSession): {
  readonly byKey: ReadonlySignal<ReadonlyMap<string, readonly string[]>>;
  readonly byCommand: ReadonlySignal<ReadonlyMap<string, readonly string[]>>;
} {
  const { page, commands } = session;
  const byCommand = computed(() => keymap(commands.all(), page.settings.value));
  const byKey = computed(() => {
    const found = new Map<string, string[]>();
    for (const [id, keys] of byCommand.value) {
      for (const key of keys) {
        if (BY_EVENT[id] !== key) found.set(key, [...(found.get(key) ?? []), id]);
      }
    }
    return found;
  });
  return { byKey, byCommand };
}

/** Listens to a window until the returned function is called. */
export function listenToKeys(session: AppSession, view: Window): () => void {
  const { byKey } = keysOf(session);
  const press = (event: KeyboardEvent) => {
    const key = event.defaultPrevented ? null : keyName(event);
    if (key === null || !counts(key, focusOf(event.target))) return;
    const all = (byKey.peek().get(key) ?? []).flatMap((id) => session.commands.find(id) ?? []);
    // A key that is held makes one state, not one for each repetition.
    const meant = event.repeat ? all.filter(({ once }) => !once) : all;
    for (const command of meant) {
      if (focusOf(event.target) === "text") settle(event.target as HTMLElement);
      if (!session.commands.choose(command, session.context())) continue;
      event.preventDefault();
      return;
    }
    const isReported = !event.repeat && meant.some((command) => tellRefusal(session, command));
    if (isReported || isOurs(key)) event.preventDefault();
  };
  view.addEventListener("keydown", press);
  return () => view.removeEventListener("keydown", press);
}

/** Reports the reason why the command of a key is unavailable; false without a reason. */
function tellRefusal({ page, context }: AppSession, command: UserCommand): boolean {
  const refusal = refusalOf(command, context());
  if (refusal === null) return false;
  const text = refusal === "" ? whyDisabled(command, context()) : refusal;
  if (text === null) return false;
  page.tell({ level: "info", text: `${command.title}: ${text}` });
  return true;
}

/** A text that is being written counts before the command does. */
function settle(field: HTMLElement): void {
  field.blur();
  field.focus();
}

/** Keys whose meaning in browsers would surprise here, also when nothing can be done. */
function isOurs(key: string): boolean {
  return key === "Ctrl+S" || key === "Ctrl+O" || key === "Ctrl+Shift+S";
}
