/** Context menu of elements of the active machine, at a position in the window. It equals the menu of the canvas. */

import { keymap } from "../commands/keys.ts";
import { contextMenu } from "../commands/menus.ts";
import type { ElementRef } from "../model/element.ts";
import type { Point } from "../model/geometry.ts";
import { ContextMenu } from "../ui/menu.tsx";
import { useHost } from "./context.tsx";

interface ElementMenuProps {
  readonly at: Point;
  readonly elements: readonly ElementRef[];
  readonly onClose: () => void;
}

export function ElementMenu({ at, elements, onClose }: ElementMenuProps) {
  const { commands, context } = useHost();
  const now = context();
  const map = keymap(commands.all(), now.page.settings.peek());
  const keys = (id: string) => map.get(id) ?? [];
  return (
    <ContextMenu
      label="Actions for the selection"
      at={at}
      items={contextMenu({ commands, context: now, keys }, elements)}
      onClose={onClose}
    />
  );
}
