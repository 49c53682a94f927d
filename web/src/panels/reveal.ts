/** Selects an element of the active machine, and moves it into view. For a deleted element, the innermost existing state around it. */

import { type ElementRef, keyOf } from "../model/element.ts";
import { parentOf } from "../model/path.ts";
import { isThere } from "../store/page/selection.ts";
import { select } from "../store/page/view.ts";
import type { PanelHost } from "./context.tsx";

export function reveal(host: PanelHost, element: ElementRef): void {
  const { tab, canvas } = host.context();
  if (!tab) return;
  const { machine } = tab.session;
  let found: ElementRef = element;
  while (!isThere(machine, found)) {
    const isInside = found.kind !== "state" && machine.state(found.path) !== undefined;
    const path = isInside ? found.path : parentOf(found.path);
    if (path === null) return;
    found = { kind: "state", path };
  }
  const chosen = tab.view.selection.peek();
  if (chosen.size !== 1 || !chosen.has(keyOf(found))) select(tab.view, [found]);
  canvas?.reveal(found);
}
