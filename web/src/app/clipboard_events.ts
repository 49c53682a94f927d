/** The browser's own copy, cut and paste, where they are about states and not about text. */

import { focusOf } from "./keyboard.ts";
import type { AppSession } from "./session.ts";

const COMMANDS = { copy: "edit.copy", cut: "edit.cut", paste: "edit.paste" } as const;

/** Listens to a document until the returned function is called. */
export function listenToClipboard(session: AppSession, page: Document): () => void {
  const happened = (event: ClipboardEvent) => {
    if (event.defaultPrevented || !event.clipboardData) return;
    if (focusOf(event.target) === "text" || isTextSelected(page)) return;
    const id = COMMANDS[event.type as keyof typeof COMMANDS];
    if (session.commands.run(id, session.context(), event.clipboardData)) event.preventDefault();
  };
  const kinds = ["copy", "cut", "paste"] as const;
  for (const kind of kinds) page.addEventListener(kind, happened);
  return () => {
    for (const kind of kinds) page.removeEventListener(kind, happened);
  };
}

function isTextSelected(page: Document): boolean {
  return (page.getSelection()?.toString() ?? "") !== "";
}
