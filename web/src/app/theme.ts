/** Theme of the page: that of the system, or the user's choice. */

import { effect, signal } from "@preact/signals-core";
import type { Page } from "../store/page/page.ts";

/** Keeps the `data-theme` of the document in a window as settings, or else the system, have it: styles go by it alone. */
export function applyTheme(page: Pick<Page, "settings">, view: Window): () => void {
  const wish = view.matchMedia("(prefers-color-scheme: light)");
  const wanted = signal(wish.matches);
  const follow = () => {
    wanted.value = wish.matches;
  };
  wish.addEventListener("change", follow);
  const stop = effect(() => {
    const { theme } = page.settings.value;
    const own = wanted.value ? "light" : "dark";
    view.document.documentElement.dataset["theme"] = theme === "system" ? own : theme;
  });
  return () => {
    stop();
    wish.removeEventListener("change", follow);
  };
}
