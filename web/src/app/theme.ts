/** Which theme the page wears: as the system does, or as the user says. */

import { effect } from "@preact/signals-core";
import type { Page } from "../store/page.ts";

/** Keeps the document's theme as settings have it. Styles go by `data-theme` and the system's wish. */
export function wearTheme(page: Page, root: HTMLElement): () => void {
  return effect(() => {
    const { theme } = page.settings.value;
    if (theme === "system") delete root.dataset["theme"];
    else root.dataset["theme"] = theme;
  });
}
