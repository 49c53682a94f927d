/** Shows an element of any open machine, and activates its tab first. */

import type { ElementRef } from "../model/element.ts";
import type { OpenTab } from "../store/page/page.ts";
import { select } from "../store/page/view.ts";
import type { PanelHost } from "./context.tsx";
import { reveal } from "./reveal.ts";

/** Maximum number of frames to wait for the canvas of another machine. */
const PICTURES_MAX = 60;

export function goTo(host: PanelHost, tab: OpenTab, element: ElementRef): void {
  const { page, canvas } = host.context();
  if (page.active.peek() === tab) {
    reveal(host, element);
    return;
  }
  select(tab.view, [element]);
  page.active.value = tab;
  const look = (pictures: number) => {
    const now = host.context();
    if (now.tab !== tab || pictures === 0) return;
    if (now.canvas && now.canvas !== canvas) reveal(host, element);
    else requestAnimationFrame(() => look(pictures - 1));
  };
  requestAnimationFrame(() => look(PICTURES_MAX));
}
