/** Reports uncaught errors of the program to the user, because a silent failure looks like success. */

import type { Page } from "../store/page/page.ts";

/** Browsers report this for layouts that settle one frame later; it is no fault. */
const HARMLESS = /^ResizeObserver loop/;

/** Listens to a window until the returned function is called. */
export function reportErrors(page: Pick<Page, "tell">, view: Window): () => void {
  const tell = (fault: unknown, message?: string) => {
    const text = fault instanceof Error ? fault.message : String(fault ?? message);
    if (HARMLESS.test(text)) return;
    page.tell({
      level: "error",
      text: `Error in the page: ${text}. If something stops responding, reload the page. Your edits are kept.`,
    });
  };
  const failed = ({ error, message }: ErrorEvent) => tell(error, message);
  const rejected = ({ reason }: PromiseRejectionEvent) => tell(reason);
  view.addEventListener("error", failed);
  view.addEventListener("unhandledrejection", rejected);
  return () => {
    view.removeEventListener("error", failed);
    view.removeEventListener("unhandledrejection", rejected);
  };
}

/** Reports the error of a panel, which shows its message itself, with the stack: in the console, and without a toast in the log. */
export function reportPanelError(page: Pick<Page, "tell">, name: string, error: unknown): void {
  console.error(`${name} cannot be shown`, error);
  const stack = error instanceof Error ? (error.stack ?? error.message) : String(error);
  page.tell({ level: "error", text: `${name} cannot be shown: ${stack}`, isQuiet: true });
}

export function reportTranslation(page: Pick<Page, "tell">): void {
  page.tell({
    level: "warning",
    text: "A translator changes the texts of this page. The page restores them, because a translated text can be out of date. Turn the translator off for this page.",
  });
}
